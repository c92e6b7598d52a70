//! Many points of the scene over the picture: photons and cache records.

use std::sync::Arc;

use egui_wgpu::wgpu;
use glam::Vec2;

use super::pipelines::module;
use crate::engine::camera::Projection;

/// A point, as the graphics card holds it: sixteen bytes.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Point {
    /// Where.
    pub p: [f32; 3],
    /// Red, green, blue as displayed, and 255.
    pub color: [u8; 4],
}

/// Points in an order of their own; other points have another number.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// They.
    pub list: Arc<Vec<Point>>,
    /// Counts changes.
    pub number: u64,
}

/// Depth of the nearest surface on a coarse grid over the picture, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Depths {
    /// Columns and rows; 0: nothing hides.
    pub size: [u32; 2],
    /// Along the view direction.
    pub depths: Vec<f32>,
}

/// Points over the picture: made anew for every repaint.
#[derive(Clone)]
pub struct PointsLayer {
    /// All points.
    pub points: Points,
    /// How many of them are shown.
    pub count: usize,
    /// How the scene is seen.
    pub projection: Projection,
    /// Left top corner of the picture in its area, and pixels of the target per pixel of it.
    pub place: (Vec2, f32),
    /// Side of a point in pixels of the target.
    pub side: u32,
    /// They stand on black.
    pub alone: bool,
    /// What hides them.
    pub depths: Arc<Depths>,
}

/// The shader's `View`.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct ViewUniform {
    position: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    film: [f32; 2],
    corner: [f32; 2],
    area: [f32; 2],
    scale: f32,
    side: f32,
    grid: [u32; 2],
    padding: [u32; 2],
}

/// What stays on the graphics card between repaints.
pub struct PointResources {
    /// For points larger than a pixel, and for those of one.
    quads: wgpu::RenderPipeline,
    pixels: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    view: wgpu::Buffer,
    points: wgpu::Buffer,
    depths: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    /// Number of the points that are there.
    held: Option<u64>,
    /// Depths that are there.
    hidden_by: Option<Arc<Depths>>,
    count: u32,
    large: bool,
}

/// All that a drawing of points depends on.
pub(super) type PointsKey = (u64, usize, Projection, (Vec2, f32), bool, u32, usize);

impl PointsLayer {
    /// Equal keys make equal drawings.
    pub(super) fn key(&self) -> PointsKey {
        let depths = Arc::as_ptr(&self.depths) as usize;
        let (number, side) = (self.points.number, self.side);
        let (view, place) = (self.projection, self.place);
        (number, self.count, view, place, self.alone, side, depths)
    }
}

impl PointResources {
    /// Empty buffers for targets of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let module = module(device, "points", include_str!("points.wgsl"));
        let layout = bind_group_layout(device);
        let view = buffer(
            device,
            "view of points",
            size_of::<ViewUniform>() as u64,
            wgpu::BufferUsages::UNIFORM,
        );
        let depths = buffer(device, "depths", 4, wgpu::BufferUsages::STORAGE);
        Self {
            quads: pipeline(device, &module, format, &layout, true),
            pixels: pipeline(device, &module, format, &layout, false),
            bind_group: bind(device, &layout, &view, &depths),
            points: buffer(device, "points", 16, wgpu::BufferUsages::VERTEX),
            layout,
            view,
            depths,
            held: None,
            hidden_by: None,
            count: 0,
            large: true,
        }
    }

    /// Uploads what has changed.
    pub(super) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        c: &PointsLayer,
        area: Vec2,
    ) {
        if self.held != Some(c.points.number) {
            self.held = Some(c.points.number);
            let bytes: &[u8] = bytemuck::cast_slice(&c.points.list);
            if self.points.size() < bytes.len() as u64 {
                let size = bytes.len() as u64;
                self.points = buffer(device, "points", size, wgpu::BufferUsages::VERTEX);
            }
            queue.write_buffer(&self.points, 0, bytes);
        }
        let same = |held: &Arc<Depths>| Arc::ptr_eq(held, &c.depths);
        if !self.hidden_by.as_ref().is_some_and(same) {
            self.hidden_by = Some(Arc::clone(&c.depths));
            let bytes: &[u8] = bytemuck::cast_slice(&c.depths.depths);
            if self.depths.size() < bytes.len() as u64 {
                let size = bytes.len() as u64;
                self.depths = buffer(device, "depths", size, wgpu::BufferUsages::STORAGE);
                self.bind_group = bind(device, &self.layout, &self.view, &self.depths);
            }
            queue.write_buffer(&self.depths, 0, bytes);
        }
        let p = &c.projection;
        let four = |v: glam::Vec3A| v.extend(0.0).to_array();
        let view = ViewUniform {
            position: four(p.position),
            right: four(p.right),
            up: four(p.up),
            forward: four(p.forward),
            film: p.size.to_array(),
            corner: c.place.0.to_array(),
            area: area.to_array(),
            scale: c.place.1,
            side: c.side.max(1) as f32,
            grid: c.depths.size,
            padding: [0; 2],
        };
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        self.count = c.count.min(c.points.list.len()) as u32;
        self.large = c.side > 1;
    }

    /// Draws them; the viewport is the area.
    pub(super) fn paint(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.count == 0 {
            return;
        }
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, self.points.slice(..));
        if self.large {
            pass.set_pipeline(&self.quads);
            pass.draw(0..4, 0..self.count);
        } else {
            pass.set_pipeline(&self.pixels);
            pass.draw(0..self.count, 0..1);
        }
    }
}

fn buffer(
    device: &wgpu::Device,
    label: &str,
    size: u64,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding: u32, ty: wgpu::BufferBindingType| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("points"),
        entries: &[
            entry(0, wgpu::BufferBindingType::Uniform),
            entry(1, storage),
        ],
    })
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    view: &wgpu::Buffer,
    depths: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let entries = [
        wgpu::BindGroupEntry {
            binding: 0,
            resource: view.as_entire_binding(),
        },
        wgpu::BindGroupEntry {
            binding: 1,
            resource: depths.as_entire_binding(),
        },
    ];
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("points"),
        layout,
        entries: &entries,
    })
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    format: wgpu::TextureFormat,
    layout: &wgpu::BindGroupLayout,
    quads: bool,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("points"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let (topology, step_mode) = if quads {
        let strip = wgpu::PrimitiveTopology::TriangleStrip;
        (strip, wgpu::VertexStepMode::Instance)
    } else {
        let points = wgpu::PrimitiveTopology::PointList;
        (points, wgpu::VertexStepMode::Vertex)
    };
    let flag = |on: bool| f64::from(u8::from(on));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("points"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("quads", flag(quads))],
                ..wgpu::PipelineCompilationOptions::default()
            },
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Point>() as u64,
                step_mode,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4],
            })],
        },
        primitive: wgpu::PrimitiveState {
            topology,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("target_encodes", flag(format.is_srgb()))],
                ..wgpu::PipelineCompilationOptions::default()
            },
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
