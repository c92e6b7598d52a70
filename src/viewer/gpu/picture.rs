//! Draws the picture below the panels: into a canvas when it changed, and from there within
//! egui's render pass.

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
    bind_group: Option<wgpu::BindGroup>,
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
            bind_group: None,
            canvas: Canvas::new(device, format),
            points: PointResources::new(device, format),
            drawn: None,
        }
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
        if new || self.bind_group.is_none() {
            self.bind_group = self.bind(device);
        }
        let area = PixelRect {
            min: Vec2::ZERO,
            ..area
        };
        self.draw(device, queue, encoder, picture, &tiles, area, &slots);
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "device, queue and encoder go together"
    )]
    fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        picture: &PictureCallback,
        tiles: &[Tile],
        area: PixelRect,
        slots: &[usize],
    ) {
        let (Some(bind_group), Some(view)) = (&self.bind_group, self.canvas.view()) else {
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
            if rect.size.min_element() < 1.0 {
                continue;
            }
            let (display, placement) = (&picture.display, picture.placement);
            let (numbers, variant) = uniform(&picture.frame, display, placement, tile, rect, slots);
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
            layout: &self.pipelines.layout,
            entries: &entries,
        }))
    }

    pub(super) fn paint(&self, pass: &mut wgpu::RenderPass<'_>, target: [u32; 2]) {
        self.canvas.paint(pass, target);
    }
}
