//! The finished picture in a texture: panels are drawn again far more often than it changes.

use egui_wgpu::wgpu;
use glam::{UVec2, Vec2};

use super::layout::PixelRect;
use super::pipelines::{module, pipeline};

/// A texture as large as the picture's area, and what copies it there.
pub struct Canvas {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
    corner: wgpu::Buffer,
    area: PixelRect,
    texture: Option<(wgpu::TextureView, wgpu::BindGroup)>,
}

impl Canvas {
    /// Without a texture yet.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = bind_group_layout(device);
        let module = module(device, "blit", include_str!("blit.wgsl"));
        Self {
            pipeline: pipeline(device, &module, format, &layout, &[]),
            layout,
            format,
            corner: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("corner"),
                size: size_of::<[f32; 4]>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            area: PixelRect {
                min: Vec2::ZERO,
                size: Vec2::ZERO,
            },
            texture: None,
        }
    }

    /// Takes the place `area` of the target. True if there is a new texture, which is empty.
    pub fn place(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, area: PixelRect) -> bool {
        if area.min != self.area.min || self.texture.is_none() {
            let corner = [area.min.x, area.min.y, 0.0, 0.0];
            queue.write_buffer(&self.corner, 0, bytemuck::cast_slice(&corner));
        }
        let renewed = area.size != self.area.size || self.texture.is_none();
        self.area = area;
        if renewed {
            self.texture = self.texture(device);
        }
        renewed
    }

    /// Memory of the texture, at four bytes a pixel.
    pub fn bytes(&self) -> u64 {
        let [x, y] = self.area.size.to_array().map(|side| side as u64);
        if self.texture.is_some() { x * y * 4 } else { 0 }
    }

    /// What the picture is drawn to.
    pub fn view(&self) -> Option<&wgpu::TextureView> {
        self.texture.as_ref().map(|(view, _)| view)
    }

    fn texture(&self, device: &wgpu::Device) -> Option<(wgpu::TextureView, wgpu::BindGroup)> {
        let size = self.area.size.as_uvec2();
        let largest = device.limits().max_texture_dimension_2d;
        if size == UVec2::ZERO || size.min_element() == 0 || size.max_element() > largest {
            return None;
        }
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: self.corner.as_entire_binding(),
                },
            ],
        });
        Some((view, bind_group))
    }

    /// Copies the picture to a target of `target` pixels.
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>, target: [u32; 2]) {
        let Some((_, bind_group)) = &self.texture else {
            return;
        };
        let target = Vec2::new(target[0] as f32, target[1] as f32);
        let min = self.area.min.clamp(Vec2::ZERO, target);
        let size = (self.area.min + self.area.size).clamp(min, target) - min;
        if size.min_element() < 1.0 {
            return;
        }
        pass.set_viewport(min.x, min.y, size.x, size.y, 0.0, 1.0);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding: u32, ty: wgpu::BindingType| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("blit"),
        entries: &[entry(0, texture), entry(1, uniform)],
    })
}
