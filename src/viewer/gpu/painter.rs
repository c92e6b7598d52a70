//! The window's surface and device, by egui's painter.

use std::sync::Arc;

use egui_wgpu::wgpu;
use egui_wgpu::winit::Painter;
use egui_wgpu::{RendererOptions, WgpuConfiguration, WgpuError, WgpuSetup, WgpuSetupCreateNew};
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::picture::Resources;

/// Prepares drawing in `window`; `lost` is called when the device is gone.
///
/// # Errors
/// What the system says, if nothing here can draw in a window.
pub fn create(
    context: &egui::Context,
    display: OwnedDisplayHandle,
    window: &Arc<Window>,
    lost: impl Fn() + Send + Sync + 'static,
) -> Result<Painter, String> {
    // OpenGL comes second: it is slower to start and louder where it is not there.
    let painter = with_backends(wgpu::Backends::PRIMARY, context, &display, window)
        .or_else(|_| with_backends(wgpu::Backends::GL, context, &display, window))
        .map_err(|error| error.to_string())?;
    let state = painter.render_state().ok_or("it has no device")?;
    state.device.set_device_lost_callback(move |reason, _| {
        // Dropping a device on purpose is no loss.
        if reason != wgpu::DeviceLostReason::Destroyed {
            lost();
        }
    });
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

/// All that the adapter can: pictures are as large as it allows.
fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("lightscope"),
        required_limits: adapter.limits(),
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

/// Waits until the device has done what it was given: a copy of the window arrives then.
pub fn wait(painter: &Painter) {
    if let Some(state) = painter.render_state() {
        // A device that fails here is lost, which is told apart.
        let _ = state.device.poll(wgpu::PollType::wait_indefinitely());
    }
}
