// Copies the finished picture to its place, pixel by pixel.

@group(0) @binding(0) var picture: texture_2d<f32>;
// Left top of the picture on the target, in pixels.
@group(0) @binding(1) var<uniform> corner: vec4<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the viewport.
    let corner_of_clip = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner_of_clip * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(picture, vec2<i32>(position.xy - corner.xy), 0);
}
