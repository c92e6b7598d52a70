//! The picture's pipelines: one for each way to show it, made when it is shown first. Software
//! drivers compute every branch of a shader, so that one pipeline for all would cost as much as
//! all together.

use std::collections::HashMap;

use egui_wgpu::wgpu;

use super::layers::SLOTS;

/// Index of false colours in the shader.
pub const FALSE_COLOR: u32 = 4;

/// What a pipeline is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Index into `ToneMap::ALL`, or 4 for false colours.
    pub curve: u32,
    /// Interpolates between pixels.
    pub smooth: bool,
    /// Buffers whose sum is shown.
    pub layers: u32,
}

/// Pipelines for one format of target.
pub struct Pipelines {
    module: wgpu::ShaderModule,
    format: wgpu::TextureFormat,
    /// Of the one bind group.
    pub layout: wgpu::BindGroupLayout,
    made: HashMap<Variant, wgpu::RenderPipeline>,
}

impl Pipelines {
    /// None made yet.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let source = include_str!("picture.wgsl");
        Self {
            module: module(device, "picture", source),
            format,
            layout: bind_group_layout(device),
            made: HashMap::new(),
        }
    }

    /// Of the targets.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// A variant that has no pipeline yet; the likeliest first.
    pub fn missing(&self) -> Option<Variant> {
        let variant = |layers: u32| {
            (0..=FALSE_COLOR).flat_map(move |curve| {
                [false, true].map(|smooth| Variant {
                    curve,
                    smooth,
                    layers,
                })
            })
        };
        let mut all = (1..SLOTS as u32).flat_map(variant);
        all.find(|variant| !self.made.contains_key(variant))
    }

    /// The pipeline for `variant`.
    pub fn get(&mut self, device: &wgpu::Device, variant: Variant) -> &wgpu::RenderPipeline {
        let Self {
            module,
            format,
            layout,
            made,
        } = self;
        made.entry(variant).or_insert_with(|| {
            let flag = |on: bool| f64::from(u8::from(on));
            let constants = [
                ("curve", f64::from(variant.curve)),
                ("smooth_pixels", flag(variant.smooth)),
                ("layers", f64::from(variant.layers)),
                ("target_encodes", flag(format.is_srgb())),
            ];
            pipeline(device, module, *format, layout, &constants)
        })
    }
}

/// A shader.
pub fn module(device: &wgpu::Device, label: &str, source: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

/// A pipeline that covers its viewport.
pub fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    format: wgpu::TextureFormat,
    layout: &wgpu::BindGroupLayout,
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("picture"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("picture"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
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
