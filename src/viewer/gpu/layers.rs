//! The shown layers of a frame in buffers of the graphics card.

use egui_wgpu::wgpu;
use wgpu::util::StagingBelt;
use wgpu::{Buffer, BufferDescriptor, BufferSize, BufferUsages, CommandEncoder, Device};

use crate::engine::film::Frame;

/// Most layers in one sum.
pub(super) const SLOTS: usize = 4;

/// One buffer a layer, and the staging memory on the way to them, which is used again.
pub(super) struct Layers {
    buffers: Vec<Buffer>,
    belt: Option<StagingBelt>,
    /// Bytes of one layer's buffer.
    capacity: u64,
    /// What the buffers hold: number of the frame and its layers.
    held: Option<(u64, Vec<usize>)>,
}

impl Layers {
    pub fn new() -> Self {
        Self {
            buffers: Vec::new(),
            belt: None,
            capacity: 0,
            held: None,
        }
    }

    /// Memory of the buffers.
    pub fn bytes(&self) -> u64 {
        self.buffers.len() as u64 * self.capacity
    }

    /// The buffers of `layers`, the others stood in for by the first buffer.
    pub fn buffers(&self, layers: &[usize]) -> Option<[&Buffer; SLOTS]> {
        let first = self.buffers.first()?;
        let (_, held) = self.held.as_ref()?;
        let of = |layer: &usize| self.buffers.get(held.iter().position(|h| h == layer)?);
        Some(std::array::from_fn(|i| {
            layers.get(i).and_then(of).unwrap_or(first)
        }))
    }

    /// Uploads `slots` of frame `number` unless they are there already. True if layers lie in
    /// other buffers than before.
    pub fn upload(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        number: u64,
        frame: &Frame,
        slots: &[usize],
    ) -> bool {
        let key = (number, slots.to_vec());
        if self.held.as_ref() == Some(&key) {
            return false;
        }
        let size = u64::from(frame.size.x) * u64::from(frame.size.y) * 12;
        let full = u64::from(frame.full_size.x) * u64::from(frame.full_size.y) * 12;
        let renewed = self.reserve(device, full.max(size), slots.len());
        let moved = renewed || self.held.as_ref().is_none_or(|(_, held)| held != slots);
        let (Some(belt), Some(bytes)) = (&mut self.belt, BufferSize::new(size)) else {
            return moved;
        };
        for (&slot, buffer) in slots.iter().zip(&self.buffers) {
            let Some(layer) = frame.layers.get(slot) else {
                continue;
            };
            let mut view = belt.write_buffer(encoder, buffer, 0, bytes);
            view.copy_from_slice(bytemuck::cast_slice(&layer.pixels));
        }
        belt.finish_and_recall_on_submit(encoder);
        self.held = Some(key);
        moved
    }

    /// Makes room for `count` layers of `bytes`.
    fn reserve(&mut self, device: &Device, bytes: u64, count: usize) -> bool {
        if bytes == 0 {
            return false;
        }
        let mut renewed = false;
        if bytes != self.capacity {
            self.buffers.clear();
            self.belt = Some(StagingBelt::new(device.clone(), bytes));
            self.capacity = bytes;
            renewed = true;
        }
        while self.buffers.len() < count {
            self.buffers.push(device.create_buffer(&BufferDescriptor {
                label: Some("layer"),
                size: bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
            renewed = true;
        }
        renewed
    }
}
