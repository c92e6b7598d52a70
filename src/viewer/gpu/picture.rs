//! Draws the picture below the panels, within egui's render pass.

use std::sync::Arc;

use egui_wgpu::wgpu;
use egui_wgpu::{CallbackResources, CallbackTrait, ScreenDescriptor};
use glam::Vec2;

use super::layers::{Layers, SLOTS};
use super::layout::{PixelRect, Placement, TileUniform, uniform};
use crate::engine::film::Frame;
use crate::viewer::display::Display;

/// Most tiles at once.
const MAX_TILES: usize = 4;

/// One picture to be drawn: made anew for every repaint.
pub struct PictureCallback {
    /// The frame.
    pub frame: Arc<Frame>,
    /// Number of the frame: other frames have other numbers.
    pub number: u64,
    /// How it is shown.
    pub display: Display,
    /// How it lies in its area.
    pub placement: Placement,
    /// The area in points.
    pub area: egui::Rect,
}

/// What stays on the graphics card between repaints.
pub struct Resources {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    uniforms: wgpu::Buffer,
    stride: u64,
    encodes: bool,
    layers: Layers,
    bind_group: Option<wgpu::BindGroup>,
    tiles: Vec<PixelRect>,
}

impl CallbackTrait for PictureCallback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(resources) = resources.get_mut::<Resources>() {
            let area = physical(self.area, screen.pixels_per_point);
            resources.prepare(device, queue, encoder, self, area);
        }
        Vec::new()
    }

    fn paint(
        &self,
        info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(resources) = resources.get::<Resources>() {
            resources.paint(pass, info.screen_size_px);
        }
    }
}

/// A rectangle of points in whole physical pixels.
fn physical(rect: egui::Rect, pixels_per_point: f32) -> PixelRect {
    let scaled = |p: egui::Pos2| (Vec2::new(p.x, p.y) * pixels_per_point).round();
    let min = scaled(rect.min);
    PixelRect {
        min,
        size: scaled(rect.max) - min,
    }
}

impl Resources {
    /// Pipeline and empty buffers for targets of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = bind_group_layout(device);
        let alignment = device.limits().min_uniform_buffer_offset_alignment;
        let stride = (size_of::<TileUniform>() as u64).next_multiple_of(u64::from(alignment));
        Self {
            pipeline: pipeline(device, format, &layout),
            uniforms: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tiles"),
                size: stride * MAX_TILES as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            layout,
            stride,
            encodes: format.is_srgb(),
            layers: Layers::new(),
            bind_group: None,
            tiles: Vec::new(),
        }
    }

    pub(super) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        picture: &PictureCallback,
        area: PixelRect,
    ) {
        let tiles = picture.display.tiles();
        let mut slots: Vec<usize> = tiles
            .iter()
            .flat_map(|t| t.layers.iter().copied())
            .collect();
        slots.sort_unstable();
        slots.dedup();
        slots.truncate(SLOTS);
        let frame = &picture.frame;
        // Without layers the sum is black; a buffer must be bound all the same.
        let uploaded = if slots.is_empty() { &[0][..] } else { &slots };
        if self
            .layers
            .upload(device, encoder, picture.number, frame, uploaded)
        {
            self.bind_group = None;
        }
        self.tiles = tiles.iter().map(|tile| area.of_tile(tile)).collect();
        for (i, (tile, rect)) in tiles.iter().zip(&self.tiles).enumerate() {
            let numbers = uniform(
                frame,
                &picture.display,
                picture.placement,
                tile,
                *rect,
                &slots,
            )
            .for_target(self.encodes);
            queue.write_buffer(
                &self.uniforms,
                self.stride * i as u64,
                bytemuck::bytes_of(&numbers),
            );
        }
        if self.bind_group.is_none() {
            self.bind_group = self.bind(device);
        }
    }

    fn bind(&self, device: &wgpu::Device) -> Option<wgpu::BindGroup> {
        let buffers = self.layers.buffers()?;
        let tile = wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &self.uniforms,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<TileUniform>() as u64),
            }),
        };
        let layers = buffers
            .iter()
            .enumerate()
            .map(|(i, buffer)| wgpu::BindGroupEntry {
                binding: i as u32 + 1,
                resource: buffer.as_entire_binding(),
            });
        let entries: Vec<wgpu::BindGroupEntry<'_>> = std::iter::once(tile).chain(layers).collect();
        Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &self.layout,
            entries: &entries,
        }))
    }

    pub(super) fn paint(&self, pass: &mut wgpu::RenderPass<'_>, target: [u32; 2]) {
        let Some(bind_group) = &self.bind_group else {
            return;
        };
        pass.set_pipeline(&self.pipeline);
        let target = Vec2::new(target[0] as f32, target[1] as f32);
        for (i, tile) in self.tiles.iter().enumerate() {
            let min = tile.min.clamp(Vec2::ZERO, target);
            let size = (tile.min + tile.size).clamp(min, target) - min;
            if size.min_element() < 1.0 {
                continue;
            }
            pass.set_viewport(min.x, min.y, size.x, size.y, 0.0, 1.0);
            pass.set_bind_group(0, bind_group, &[(self.stride * i as u64) as u32]);
            pass.draw(0..3, 0..1);
        }
    }
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let buffer = |binding: u32, ty: wgpu::BufferBindingType| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: binding == 0,
            min_binding_size: None,
        },
        count: None,
    };
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    let mut entries = vec![buffer(0, wgpu::BufferBindingType::Uniform)];
    entries.extend((1..=SLOTS as u32).map(|binding| buffer(binding, storage)));
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("picture"),
        entries: &entries,
    })
}

fn pipeline(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    layout: &wgpu::BindGroupLayout,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("picture"),
        source: wgpu::ShaderSource::Wgsl(include_str!("picture.wgsl").into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("picture"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("picture"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
