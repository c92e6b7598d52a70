//! The window's surface and device, by egui's painter.

use std::sync::Arc;

use egui_wgpu::wgpu;
use egui_wgpu::winit::Painter;
use egui_wgpu::{
    RendererOptions, SurfaceErrorAction, WgpuConfiguration, WgpuError, WgpuSetup,
    WgpuSetupCreateNew,
};
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::picture::Resources;

/// Prepares drawing in `window`; `lost` is called when the device is gone, also when it is given
/// up on purpose, and `failed` with a sentence when it refuses something.
///
/// # Errors
/// What the system says, if nothing here can draw in a window.
pub fn create(
    context: &egui::Context,
    display: OwnedDisplayHandle,
    window: &Arc<Window>,
    lost: impl Fn() + Send + Sync + 'static,
    failed: impl Fn(String) + Send + Sync + 'static,
) -> Result<Painter, String> {
    // OpenGL comes second: it is slower to start and louder where it is not there.
    let painter = with_backends(wgpu::Backends::PRIMARY, context, &display, window)
        .or_else(|_| with_backends(wgpu::Backends::GL, context, &display, window))
        .map_err(|error| error.to_string())?;
    let state = painter.render_state().ok_or("it has no device")?;
    state.device.set_device_lost_callback(move |_, _| lost());
    // Without a handler the program would end.
    let refused = move |error: wgpu::Error| failed(sentence(&error));
    state.device.on_uncaptured_error(Arc::new(refused));
    let resources = Resources::new(&state.device, state.target_format);
    state.renderer.write().callback_resources.insert(resources);
    Ok(painter)
}

fn with_backends(
    backends: wgpu::Backends,
    context: &egui::Context,
    display: &OwnedDisplayHandle,
    window: &Arc<Window>,
) -> Result<Painter, WgpuError> {
    let mut setup = WgpuSetupCreateNew::from_display_handle(display.clone());
    setup.device_descriptor = Arc::new(device_descriptor);
    setup.instance_descriptor.backends = backends;
    let configuration = WgpuConfiguration {
        wgpu_setup: WgpuSetup::CreateNew(setup),
        on_surface_status: Arc::new(surface_action),
        ..WgpuConfiguration::default()
    };
    pollster::block_on(async {
        let options = RendererOptions::default();
        let mut painter = Painter::new(context.clone(), configuration, false, options).await;
        let window = Some(Arc::clone(window));
        painter.set_window(egui::ViewportId::ROOT, window).await?;
        Ok(painter)
    })
}

/// What to do when the window's surface has no picture to draw on. All but the first come with
/// another try.
fn surface_action(status: &wgpu::CurrentSurfaceTexture) -> SurfaceErrorAction {
    match status {
        // Nobody sees it; it is drawn when it is seen again.
        wgpu::CurrentSurfaceTexture::Occluded => SurfaceErrorAction::SkipFrame,
        wgpu::CurrentSurfaceTexture::Lost => SurfaceErrorAction::RecreateSurface,
        _ => SurfaceErrorAction::Reconfigure,
    }
}

/// The first line of what the driver says.
fn sentence(error: &wgpu::Error) -> String {
    let text = error.to_string();
    let line = text.lines().map(str::trim).rfind(|line| !line.is_empty());
    let line = line.unwrap_or("no reason given");
    match error {
        wgpu::Error::OutOfMemory { .. } => {
            "The graphics card has no memory left: choose a smaller picture.".to_owned()
        }
        _ => format!("The graphics driver refuses to draw: {line}."),
    }
}

/// All that the adapter can: pictures are as large as it allows.
fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("lightscope"),
        required_limits: adapter.limits(),
        // A handful of buffers that live long: blocks of 128 MiB in store would stay empty.
        memory_hints: wgpu::MemoryHints::MemoryUsage,
        ..wgpu::DeviceDescriptor::default()
    }
}

/// Most pixels of a picture that the device can hold in one buffer.
pub fn max_pixels(painter: &Painter) -> u64 {
    painter.render_state().map_or(u64::MAX, |state| {
        let limits = state.device.limits();
        limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size)
            / 12
    })
}

/// Bytes of the layers and of the picture that the device holds.
pub fn picture_bytes(painter: &Painter) -> u64 {
    let Some(state) = painter.render_state() else {
        return 0;
    };
    let renderer = state.renderer.read();
    let resources = renderer.callback_resources.get::<Resources>();
    resources.map_or(0, Resources::bytes)
}

/// True if the device draws on the processor.
pub fn is_software(painter: &Painter) -> bool {
    painter
        .render_state()
        .is_some_and(|state| state.adapter.get_info().device_type == wgpu::DeviceType::Cpu)
}

/// Prepares one more way to show the picture; false if all are there.
pub fn warm_up(painter: &Painter) -> bool {
    let Some(state) = painter.render_state() else {
        return false;
    };
    let mut renderer = state.renderer.write();
    let resources = renderer.callback_resources.get_mut::<Resources>();
    resources.is_some_and(|r| r.warm_up(&state.device, &state.queue))
}

/// Hands a new device the letters that `context` believes to be there already.
pub fn upload_font(painter: &Painter, context: &egui::Context) {
    if let Some(state) = painter.render_state() {
        let image = context.fonts(|fonts| fonts.image());
        let options = egui::epaint::TextureAtlas::texture_options();
        let delta = egui::epaint::ImageDelta::full(image, options);
        let mut renderer = state.renderer.write();
        let font = egui::TextureId::default();
        renderer.update_texture(&state.device, &state.queue, font, &delta);
    }
}

/// Loses the device, as drivers do when they are updated or hang.
pub fn destroy_device(painter: &Painter) {
    if let Some(state) = painter.render_state() {
        state.device.destroy();
        let _ = state.device.poll(wgpu::PollType::Poll);
    }
}

/// Waits until the device has done what it was given: a copy of the window arrives then.
pub fn wait(painter: &Painter) {
    if let Some(state) = painter.render_state() {
        // A device that fails here is lost, which is told apart.
        let _ = state.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_without_picture_is_tried_again_unless_nobody_sees_it() {
        use wgpu::CurrentSurfaceTexture as Status;
        for (status, action) in [
            (Status::Occluded, SurfaceErrorAction::SkipFrame),
            (Status::Lost, SurfaceErrorAction::RecreateSurface),
            (Status::Outdated, SurfaceErrorAction::Reconfigure),
            (Status::Timeout, SurfaceErrorAction::Reconfigure),
        ] {
            let chosen = surface_action(&status);
            let same = std::mem::discriminant(&chosen) == std::mem::discriminant(&action);
            assert!(same, "{status:?}");
        }
    }
}
