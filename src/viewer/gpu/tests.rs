//! The shader against `tonemap.rs`, on whatever adapter there is.

use std::sync::Arc;

use egui_wgpu::wgpu;
use glam::{UVec2, Vec2};

use super::layout::{PixelRect, Placement};
use super::picture::{PictureCallback, Resources};
use super::points::{Depths, Point, PointResources, Points, PointsLayer};
use crate::engine::film::tonemap::{NAN_COLOR, tonemap};
use crate::engine::film::{Frame, FrameLayer, ToneMap};
use crate::engine::plan::RenderPlan;
use crate::viewer::display::{Display, Shown};

/// 64 × 4 bytes are the alignment of rows that are copied to a buffer.
const SIZE: UVec2 = UVec2::new(64, 8);

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// A device; where there is none, nothing can be tested, which CI does not accept.
fn gpu() -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let found = pollster::block_on(async {
        let options = wgpu::RequestAdapterOptions::default();
        let adapter = instance.request_adapter(&options).await.ok()?;
        let descriptor = wgpu::DeviceDescriptor::default();
        let (device, queue) = adapter.request_device(&descriptor).await.ok()?;
        Some(Gpu { device, queue })
    });
    if found.is_none() {
        eprintln!("skipped: no graphics adapter; install mesa-vulkan-drivers for a software one");
        assert!(
            std::env::var_os("CI").is_none(),
            "CI has a software adapter"
        );
    }
    found
}

/// What the shader makes of `frame`.
fn shown(
    gpu: &Gpu,
    frame: &Arc<Frame>,
    display: Display,
    format: wgpu::TextureFormat,
) -> Vec<[u8; 4]> {
    let Gpu { device, queue } = gpu;
    let mut resources = Resources::new(device, format);
    let picture = PictureCallback {
        frame: Arc::clone(frame),
        number: 1,
        display,
        placement: Placement::default(),
        points: None,
        area: egui::Rect::NOTHING,
    };
    let area = PixelRect {
        min: Vec2::ZERO,
        size: SIZE.as_vec2(),
    };
    drawn(
        gpu,
        format,
        |encoder| {
            resources.prepare(device, queue, encoder, &picture, area);
            resources
        },
        |resources, pass| resources.paint(pass, SIZE.to_array()),
    )
}

/// What is on a target of `format` after `prepare` and `paint`.
fn drawn<R>(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    prepare: impl FnOnce(&mut wgpu::CommandEncoder) -> R,
    paint: impl FnOnce(&R, &mut wgpu::RenderPass<'_>),
) -> Vec<[u8; 4]> {
    let Gpu { device, queue } = gpu;
    let extent = wgpu::Extent3d {
        width: SIZE.x,
        height: SIZE.y,
        depth_or_array_layers: 1,
    };
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let read = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(SIZE.x * SIZE.y * 4),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let prepared = prepare(&mut encoder);
    {
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                resolve_target: None,
                ops: wgpu::Operations::default(),
                depth_slice: None,
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        paint(&prepared, &mut pass);
    }
    encoder.copy_texture_to_buffer(
        target.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &read,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(SIZE.x * 4),
                rows_per_image: None,
            },
        },
        extent,
    );
    queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |result| {
        result.expect("a mapped buffer")
    });
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("the device answers");
    let bytes = read.get_mapped_range(..).expect("a mapped buffer");
    bytemuck::cast_slice(&bytes).to_vec()
}

fn frame(layers: Vec<Vec<[f32; 3]>>) -> Arc<Frame> {
    let mut frame = Frame::empty(Arc::new(RenderPlan::nothing()));
    frame.size = SIZE;
    frame.full_size = SIZE;
    frame.layers = layers
        .into_iter()
        .map(|pixels| FrameLayer {
            label: String::new(),
            pixels,
        })
        .collect();
    Arc::new(frame)
}

/// Colours from deep shadow to far beyond white, grey and saturated.
fn ramp() -> Vec<[f32; 3]> {
    let pixel = |i: u32| {
        let (x, y) = (i % SIZE.x, i / SIZE.x);
        let value = (x as f32 / 63.0 * 24.0 - 14.0).exp2();
        let tint = [
            [1.0, 1.0, 1.0],
            [1.0, 0.3, 0.1],
            [0.0, 0.5, 1.0],
            [0.2, 1.0, 0.0],
        ];
        tint[y as usize % 4].map(|t: f32| t * value)
    };
    (0..SIZE.x * SIZE.y).map(pixel).collect()
}

#[test]
fn the_shader_shows_what_tonemap_says() {
    let Some(gpu) = gpu() else { return };
    let pixels = ramp();
    let frame = frame(vec![pixels.clone()]);
    for format in [
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
    ] {
        for tonemap_id in ToneMap::ALL {
            for exposure in [-2.0, 0.0, 1.5] {
                let display = Display {
                    exposure,
                    tonemap: tonemap_id,
                    ..Display::default()
                };
                let bytes = shown(&gpu, &frame, display, format);
                for (rgb, byte) in pixels.iter().zip(bytes) {
                    let expected = tonemap(tonemap_id, exposure, *rgb);
                    for c in 0..3 {
                        let difference = expected[c].abs_diff(byte[c]);
                        assert!(
                            difference <= 1,
                            "{tonemap_id:?} {exposure} {format:?}: {rgb:?} is shown as {byte:?}, \
                             not {expected:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn parts_are_summed_and_tiles_hold_their_own_part() {
    let Some(gpu) = gpu() else { return };
    let constant = |value: f32| vec![[value; 3]; (SIZE.x * SIZE.y) as usize];
    let frame = frame([9.0, 0.1, 0.2, 0.3, 0.4].map(constant).to_vec());
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let of = |shown: Shown| Display {
        shown,
        ..Display::default()
    };
    let expected = |value: f32| tonemap(ToneMap::Linear, 0.0, [value; 3]);
    let sum = shown(
        &gpu,
        &frame,
        of(Shown::Parts([true, false, true, false])),
        format,
    );
    assert_eq!(sum[0][..3], expected(0.1 + 0.3));
    let none = shown(&gpu, &frame, of(Shown::Parts([false; 4])), format);
    assert_eq!(none[100][..3], [0; 3]);
    let grid = shown(&gpu, &frame, of(Shown::Grid), format);
    // Each quarter shows the whole frame of one component, letterboxed to its own shape.
    for (x, y, value) in [(16, 2, 0.1), (48, 2, 0.2), (16, 6, 0.3), (48, 6, 0.4)] {
        assert_eq!(grid[(y * SIZE.x + x) as usize][..3], expected(value));
    }
}

#[test]
fn what_is_no_number_is_marked() {
    let Some(gpu) = gpu() else { return };
    let mut pixels = vec![[0.5; 3]; (SIZE.x * SIZE.y) as usize];
    pixels[3] = [0.0, f32::NAN, 0.0];
    pixels[4] = [f32::INFINITY, 0.0, 0.0];
    let frame = frame(vec![pixels]);
    let bytes = shown(
        &gpu,
        &frame,
        Display::default(),
        wgpu::TextureFormat::Rgba8Unorm,
    );
    assert_eq!(bytes[3][..3], NAN_COLOR);
    assert_eq!(bytes[4][..3], [0, 255, 255]);
    assert_eq!(bytes[5][..3], [188; 3]);
}

/// Where 4 × 4 pixels of the colour lie.
fn places(pixels: &[[u8; 4]], color: [u8; 3]) -> Vec<UVec2> {
    let is = |p: &[u8; 4]| p[..3] == color;
    let found = pixels.iter().enumerate().filter(|(_, p)| is(p));
    found
        .map(|(i, _)| UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x))
        .collect()
}

#[test]
fn points_lie_where_the_camera_sees_them_and_surfaces_hide_them() {
    let Some(gpu) = gpu() else { return };
    let camera = crate::engine::camera::Camera::new(&crate::engine::scene::desc::CameraDesc {
        position: glam::Vec3::new(1.0, 2.0, 3.0),
        target: glam::Vec3::ZERO,
        vfov_deg: 40.0,
        width: SIZE.x,
        height: SIZE.y,
        ..Default::default()
    })
    .expect("a view");
    let films = [
        Vec2::new(5.5, 2.5),
        Vec2::new(40.5, 6.5),
        Vec2::new(20.5, 4.5),
        Vec2::new(60.5, 1.5),
    ];
    let at = |film: Vec2, t: f32| camera.generate_ray(film, Vec2::splat(0.5)).at(t).to_array();
    let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]];
    let mut list: Vec<Point> = films
        .iter()
        .zip(colors)
        .map(|(film, [r, g, b])| Point {
            p: at(*film, 5.0),
            color: [r, g, b, 255],
        })
        .collect();
    list[2].p = at(films[2], -5.0); // behind the eye
    let show = |side: u32, count: usize, depths: Depths| {
        let callback = PointsLayer {
            points: Points {
                list: Arc::new(list.clone()),
                number: 1,
            },
            count,
            projection: camera.projection(),
            place: (Vec2::ZERO, 1.0),
            alone: false,
            side,
            depths: Arc::new(depths),
        };
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let mut resources = PointResources::new(&gpu.device, format);
        drawn(
            &gpu,
            format,
            |_| {
                resources.prepare(&gpu.device, &gpu.queue, &callback, SIZE.as_vec2());
                resources
            },
            |resources, pass| resources.paint(pass),
        )
    };
    let open = show(1, 4, Depths::default());
    for i in [0, 1, 3] {
        assert_eq!(places(&open, colors[i]), [films[i].as_uvec2()], "{i}");
    }
    assert!(places(&open, colors[2]).is_empty());
    let large = show(3, 4, Depths::default());
    assert_eq!(places(&large, colors[0]).len(), 9);
    assert_eq!(places(&large, colors[0])[4], films[0].as_uvec2());
    // The first alone; then a wall over the left half, nearer than the points.
    let first = show(1, 1, Depths::default());
    assert!(places(&first, colors[1]).is_empty() && !places(&first, colors[0]).is_empty());
    let wall = Depths {
        size: [2, 1],
        depths: vec![1.0, 1e30],
    };
    let behind = show(1, 4, wall);
    assert!(places(&behind, colors[0]).is_empty() && !places(&behind, colors[1]).is_empty());
}

/// Prints how long a million points take on this machine's driver.
#[test]
fn a_million_points_are_drawn() {
    let Some(gpu) = gpu() else { return };
    let camera = crate::engine::camera::Camera::new(&crate::engine::scene::desc::CameraDesc {
        position: glam::Vec3::new(0.0, 0.0, 3.0),
        target: glam::Vec3::ZERO,
        width: SIZE.x,
        height: SIZE.y,
        ..Default::default()
    })
    .expect("a view");
    let n = 1_000_000;
    let point = |i: u32| Point {
        p: [
            (i % 1000) as f32 * 2e-3 - 1.0,
            (i / 1000) as f32 * 2e-3 - 1.0,
            0.0,
        ],
        color: [255, 255, 255, 255],
    };
    let points = Points {
        list: Arc::new((0..n).map(point).collect()),
        number: 1,
    };
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let mut resources = PointResources::new(&gpu.device, format);
    for side in [1, 2] {
        let callback = PointsLayer {
            points: points.clone(),
            count: n as usize,
            projection: camera.projection(),
            place: (Vec2::ZERO, 1.0),
            alone: false,
            side,
            depths: Arc::default(),
        };
        for _ in 0..3 {
            let start = std::time::Instant::now();
            resources.prepare(&gpu.device, &gpu.queue, &callback, SIZE.as_vec2());
            let pixels = drawn(&gpu, format, |_| (), |(), pass| resources.paint(pass));
            assert!(!places(&pixels, [255; 3]).is_empty());
            println!("{side}: {:?}", start.elapsed());
        }
    }
}
