// Points of the scene over the picture, each a square of a few pixels.

struct View {
    // Middle of the lens; axes over their lengths at the picture's edge; view direction.
    position: vec4<f32>,
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    // Pixels of the picture.
    film: vec2<f32>,
    // Where its left top corner lies in the area, in pixels of the target.
    corner: vec2<f32>,
    // Pixels of the area.
    area: vec2<f32>,
    // Pixels of the target per pixel of the picture.
    scale: f32,
    // Side of a point in pixels.
    side: f32,
    // Columns and rows of the depths; 0: nothing hides.
    grid: vec2<u32>,
    padding: vec2<u32>,
}

// A quad for each point, or a vertex.
override quads: bool = true;
override target_encodes: bool = false;

@group(0) @binding(0) var<uniform> view: View;
// Depth of the nearest surface, row by row.
@group(0) @binding(1) var<storage, read> depths: array<f32>;

struct Drawn {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
}

// A point on a surface that is seen at an angle lies deeper than the middle of its cell.
const MARGIN: f32 = 1.03;

fn is_hidden(film: vec2<f32>, depth: f32) -> bool {
    if view.grid.x == 0u {
        return false;
    }
    let at = film / view.film * vec2<f32>(view.grid);
    let cell = clamp(vec2<i32>(floor(at)), vec2<i32>(0), vec2<i32>(view.grid) - 1);
    return depth > MARGIN * depths[u32(cell.y) * view.grid.x + u32(cell.x)];
}

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @location(0) p: vec3<f32>,
    @location(1) color: vec4<f32>,
) -> Drawn {
    var drawn: Drawn;
    drawn.color = color;
    // Beyond the clip volume: nothing is drawn.
    drawn.position = vec4<f32>(2.0, 2.0, 2.0, 1.0);
    let to = p - view.position.xyz;
    let depth = dot(to, view.forward.xyz);
    if depth <= 0.0 {
        return drawn;
    }
    let slope = vec2<f32>(dot(to, view.right.xyz), dot(to, view.up.xyz)) / depth;
    let film = (0.5 + 0.5 * slope * vec2<f32>(1.0, -1.0)) * view.film;
    if any(film < vec2<f32>(0.0)) || any(film >= view.film) || is_hidden(film, depth) {
        return drawn;
    }
    var at = view.corner + film * view.scale;
    if quads {
        let side = vec2<f32>(f32(index & 1u), f32(index >> 1u)) - 0.5;
        at += side * view.side;
    }
    let ndc = at / view.area * 2.0 - 1.0;
    drawn.position = vec4<f32>(ndc.x, -ndc.y, 0.5, 1.0);
    return drawn;
}

@fragment
fn fragment(drawn: Drawn) -> @location(0) vec4<f32> {
    let c = drawn.color.rgb;
    if target_encodes {
        let low = c / 12.92;
        let high = pow((c + 0.055) / 1.055, vec3<f32>(2.4));
        return vec4<f32>(select(high, low, c <= vec3<f32>(0.04045)), 1.0);
    }
    return vec4<f32>(c, 1.0);
}
