//! How quickly panels answer while all cores render: measured without a window, from the moment
//! an input is due to the moment the graphics device has drawn the answer.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_wgpu::wgpu;
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use glam::UVec2;

use super::gpu::Resources;
use super::opening::Opening;
use super::rendering::Rendering;
use super::source::SceneSource;
use super::workspace::Workspace;
use super::{ViewError, panels};
use crate::engine::scene::Scene;

/// Format of the picture that nobody sees.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Time between two inputs: not a multiple of a display's, so that inputs fall anywhere.
const PAUSE: Duration = Duration::from_millis(43);
/// Inputs before the first that counts: pipelines and fonts are made then.
const WARM_UP: usize = 10;

/// A window's contents on a texture.
struct Bench {
    device: wgpu::Device,
    queue: wgpu::Queue,
    target: wgpu::Texture,
    renderer: Renderer,
    context: egui::Context,
    workspace: Workspace,
    rendering: Rendering,
    size: UVec2,
    /// The device draws on the cores that render.
    software: bool,
}

/// What was measured, in milliseconds from the moment each input was due.
pub struct Latency {
    /// Until the panels had answered: laid out and ready to be drawn.
    pub answered: Vec<f64>,
    /// Until the graphics device had drawn it.
    pub drawn: Vec<f64>,
    /// Name of the device.
    pub adapter: String,
}

/// Measures `inputs` inputs.
///
/// # Errors
/// Without graphics driver.
pub fn measure(
    source: SceneSource,
    scene: Arc<Scene>,
    size: UVec2,
    inputs: usize,
) -> Result<Latency, ViewError> {
    let (mut bench, adapter) = Bench::new(source, scene, size)?;
    let mut latency = Latency {
        answered: Vec::with_capacity(inputs),
        drawn: Vec::with_capacity(inputs),
        adapter,
    };
    bench.warm_up();
    let mut due = Instant::now();
    for i in 0..WARM_UP + inputs {
        due = due.max(Instant::now()) + PAUSE;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        let answered = bench.answer(input(i));
        if i >= WARM_UP {
            let since = |at: Instant| at.saturating_duration_since(due).as_secs_f64() * 1e3;
            latency.answered.push(since(answered));
            latency.drawn.push(since(Instant::now()));
        }
    }
    Ok(latency)
}

/// The mouse wanders over the panel; now and then a key changes what is shown.
fn input(i: usize) -> Vec<egui::Event> {
    let at = egui::pos2(1000.0 + (i * 37 % 240) as f32, 20.0 + (i * 53 % 700) as f32);
    let mut events = vec![egui::Event::PointerMoved(at)];
    let keys = [
        egui::Key::Num1,
        egui::Key::Num5,
        egui::Key::Num0,
        egui::Key::T,
    ];
    if i.is_multiple_of(5) {
        events.push(egui::Event::Key {
            key: keys[i / 5 % keys.len()],
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        });
    }
    events
}

impl Bench {
    fn new(
        source: SceneSource,
        scene: Arc<Scene>,
        size: UVec2,
    ) -> Result<(Self, String), ViewError> {
        let (device, queue, adapter) = device()?;
        let software = adapter.device_type == wgpu::DeviceType::Cpu;
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let mut renderer = Renderer::new(&device, FORMAT, RendererOptions::default());
        renderer
            .callback_resources
            .insert(Resources::new(&device, FORMAT));
        let context = egui::Context::default();
        panels::apply_style(&context);
        let mut workspace = Workspace::new(source.clone());
        workspace.show_scene(Opening::scene(source), scene, false, String::new());
        let bench = Self {
            device,
            queue,
            target,
            renderer,
            context,
            workspace,
            rendering: Rendering::new(|| ()).map_err(ViewError::Failed)?,
            size,
            software,
        };
        Ok((bench, adapter.name))
    }

    /// What the window does while nobody touches it.
    fn warm_up(&mut self) {
        if let Some(resources) = self.renderer.callback_resources.get_mut::<Resources>() {
            while resources.warm_up(&self.device, &self.queue) {}
        }
    }

    /// What the window does for an input, until the device is done; returns when the panels were.
    fn answer(&mut self, events: Vec<egui::Event>) -> Instant {
        let _hold = self.software.then(|| self.rendering.hold());
        if let Some(frame) = self.rendering.new_frame() {
            self.workspace.show_frame(frame);
        }
        let size = egui::vec2(self.size.x as f32, self.size.y as f32);
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
            events,
            ..egui::RawInput::default()
        };
        let workspace = &mut self.workspace;
        let output = self.context.run_ui(input, |ui| panels::show(ui, workspace));
        let jobs = self
            .context
            .tessellate(output.shapes, output.pixels_per_point);
        let answered = Instant::now();
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.renderer
                    .update_texture(&self.device, &self.queue, *id, delta);
            }
        }
        self.draw(&jobs, output.pixels_per_point);
        if let Some(scene) = self.workspace.scene.clone() {
            let (model, pixels) = (&self.workspace.model, self.workspace.pixels());
            if let Err(sentence) = self.rendering.follow(&scene, model, pixels, false) {
                self.workspace.notices.set_error("view", sentence);
            }
        }
        answered
    }

    fn draw(&mut self, jobs: &[egui::ClippedPrimitive], pixels_per_point: f32) {
        let screen = ScreenDescriptor {
            size_in_pixels: self.size.to_array(),
            pixels_per_point,
        };
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = self.device.create_command_encoder(&descriptor);
        let (device, queue) = (&self.device, &self.queue);
        let mut commands = self
            .renderer
            .update_buffers(device, queue, &mut encoder, jobs, &screen);
        let view = self
            .target
            .create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                resolve_target: None,
                ops: wgpu::Operations::default(),
                depth_slice: None,
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        self.renderer
            .render(&mut pass.forget_lifetime(), jobs, &screen);
        commands.push(encoder.finish());
        self.queue.submit(commands);
        // A device that fails here is lost, and its times with it.
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

fn device() -> Result<(wgpu::Device, wgpu::Queue, wgpu::AdapterInfo), ViewError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    pollster::block_on(async {
        let options = wgpu::RequestAdapterOptions::default();
        let adapter = instance.request_adapter(&options).await;
        let adapter = adapter.map_err(|error| ViewError::NoAdapter(error.to_string()))?;
        let descriptor = wgpu::DeviceDescriptor::default();
        let device = adapter.request_device(&descriptor).await;
        let (device, queue) = device.map_err(|error| ViewError::NoAdapter(error.to_string()))?;
        Ok((device, queue, adapter.get_info()))
    })
}
