//! Draws the picture below the panels: into a canvas when it changed, and from there within
//! egui's render pass.

use std::collections::HashMap;
use std::sync::Arc;

use egui_wgpu::wgpu;
use egui_wgpu::{CallbackResources, CallbackTrait, ScreenDescriptor};
use glam::Vec2;

use super::canvas::Canvas;
use super::layers::{Layers, SLOTS};
use super::layout::{PixelRect, Placement, TileUniform, uniform};
use super::pipelines::Pipelines;
use super::points::{PointResources, PointsKey, PointsLayer};
use crate::engine::film::Frame;
use crate::viewer::display::{Display, Tile};

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
    /// Points of the scene over it.
    pub points: Option<PointsLayer>,
    /// The area in points.
    pub area: egui::Rect,
}

/// What stays on the graphics card between repaints.
pub struct Resources {
    pipelines: Pipelines,
    uniforms: wgpu::Buffer,
    stride: u64,
    layers: Layers,
    /// By the layers whose sum they show.
    bind_groups: HashMap<Vec<usize>, wgpu::BindGroup>,
    canvas: Canvas,
    points: PointResources,
    /// What the canvas shows: number of the frame, how, where it lies, and points over it.
    drawn: Option<(u64, Display, Placement, Option<PointsKey>)>,
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
    /// Empty buffers for targets of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let alignment = device.limits().min_uniform_buffer_offset_alignment;
        let stride = (size_of::<TileUniform>() as u64).next_multiple_of(u64::from(alignment));
        Self {
            pipelines: Pipelines::new(device, format),
            uniforms: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tiles"),
                size: stride * MAX_TILES as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            stride,
            layers: Layers::new(),
            bind_groups: HashMap::new(),
            canvas: Canvas::new(device, format),
            points: PointResources::new(device, format),
            drawn: None,
        }
    }

    /// Memory on the graphics card: layers and the picture made of them.
    pub fn bytes(&self) -> u64 {
        self.layers.bytes() + self.canvas.bytes()
    }

    /// Draws the canvas if anything about it has changed.
    pub(super) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        picture: &PictureCallback,
        area: PixelRect,
    ) {
        let renewed = self.canvas.place(device, queue, area);
        let points = picture.points.as_ref();
        let (display, placement) = (picture.display, picture.placement);
        let wanted = (
            picture.number,
            display,
            placement,
            points.map(PointsLayer::key),
        );
        if !renewed && self.drawn == Some(wanted) {
            return;
        }
        self.drawn = Some(wanted);
        if let Some(points) = points {
            self.points.prepare(device, queue, points, area.size);
        }
        let tiles = picture.display.tiles();
        let mut slots: Vec<usize> = tiles.iter().flat_map(|t| t.layers.clone()).collect();
        slots.sort_unstable();
        slots.dedup();
        // An expression that was just typed has no layer yet.
        slots.retain(|slot| *slot < picture.frame.layers.len());
        slots.truncate(SLOTS);
        // Without layers the sum is black; a buffer must be bound all the same.
        let uploaded = if slots.is_empty() { &[0][..] } else { &slots };
        let frame = &picture.frame;
        let new = self
            .layers
            .upload(device, encoder, picture.number, frame, uploaded);
        if new {
            self.bind_groups.clear();
        }
        for tile in &tiles {
            self.bind(device, &tile.layers);
        }
        let area = PixelRect {
            min: Vec2::ZERO,
            ..area
        };
        self.draw(device, queue, encoder, picture, &tiles, area);
    }

    fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        picture: &PictureCallback,
        tiles: &[Tile],
        area: PixelRect,
    ) {
        let Some(view) = self.canvas.view() else {
            return;
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                resolve_target: None,
                ops: wgpu::Operations::default(),
                depth_slice: None,
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        let alone = picture.points.as_ref().is_some_and(|points| points.alone);
        let shown = if alone { &[] } else { tiles };
        for (i, tile) in shown.iter().enumerate() {
            let rect = area.of_tile(tile);
            let Some(bind_group) = self.bind_groups.get(&tile.layers) else {
                continue;
            };
            if rect.size.min_element() < 1.0 {
                continue;
            }
            let (display, placement) = (&picture.display, picture.placement);
            let (numbers, variant) = uniform(&picture.frame, display, placement, tile, rect);
            let offset = self.stride * i as u64;
            queue.write_buffer(&self.uniforms, offset, bytemuck::bytes_of(&numbers));
            pass.set_pipeline(self.pipelines.get(device, variant));
            pass.set_viewport(rect.min.x, rect.min.y, rect.size.x, rect.size.y, 0.0, 1.0);
            pass.set_bind_group(0, bind_group, &[offset as u32]);
            pass.draw(0..3, 0..1);
        }
        if picture.points.is_some() {
            let size = area.size;
            pass.set_viewport(0.0, 0.0, size.x, size.y, 0.0, 1.0);
            self.points.paint(&mut pass);
        }
    }

    /// Makes the bind group of a sum of layers unless it is there.
    fn bind(&mut self, device: &wgpu::Device, layers: &[usize]) {
        if self.bind_groups.contains_key(layers) {
            return;
        }
        if let Some(buffers) = self.layers.buffers(layers) {
            let group = bind_group(device, &self.pipelines.layout, &self.uniforms, buffers);
            self.bind_groups.insert(layers.to_vec(), group);
        }
    }

    /// Makes one pipeline that is still missing and draws a pixel with it, nowhere to be seen:
    /// drivers compile at the first use, which takes some of them a tenth of a second. False if
    /// there was none missing.
    pub fn warm_up(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> bool {
        let Some(variant) = self.pipelines.missing() else {
            return false;
        };
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("one pixel"),
            size: 12,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let layout = &self.pipelines.layout;
        let group = bind_group(device, layout, &self.uniforms, [&buffer; SLOTS]);
        let view = one_pixel(device, self.pipelines.format());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("warm-up"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                    depth_slice: None,
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            pass.set_pipeline(self.pipelines.get(device, variant));
            pass.set_bind_group(0, &group, &[0]);
            pass.draw(0..3, 0..1);
        }
        queue.submit([encoder.finish()]);
        true
    }

    pub(super) fn paint(&self, pass: &mut wgpu::RenderPass<'_>, target: [u32; 2]) {
        self.canvas.paint(pass, target);
    }
}

fn bind_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniforms: &wgpu::Buffer,
    layers: [&wgpu::Buffer; SLOTS],
) -> wgpu::BindGroup {
    let tile = wgpu::BindGroupEntry {
        binding: 0,
        resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: uniforms,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<TileUniform>() as u64),
        }),
    };
    let layers = layers
        .iter()
        .enumerate()
        .map(|(i, buffer)| wgpu::BindGroupEntry {
            binding: i as u32 + 1,
            resource: buffer.as_entire_binding(),
        });
    let entries: Vec<wgpu::BindGroupEntry<'_>> = std::iter::once(tile).chain(layers).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("picture"),
        layout,
        entries: &entries,
    })
}

/// A target that nobody sees.
fn one_pixel(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("one pixel"),
        size: wgpu::Extent3d::default(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
