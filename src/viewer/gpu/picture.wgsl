// Shows the sum of layers in a rectangle: exposure, tone map and, once, the sRGB encoding.
// The curves are those of engine/film/tonemap.rs; a test compares the results byte by byte.

struct Tile {
    // Pixels of the layers.
    frame: vec2<u32>,
    // Factor on radiance.
    exposure: f32,
    // Linear grey around the picture.
    surround: f32,
    // Position on the layers, in their pixels, of the target's pixel position p:
    // offset + scale * p.
    offset: vec2<f32>,
    scale: vec2<f32>,
}

// Index into ToneMap::ALL, or 4 for false colours.
override curve: u32;
// Interpolate between pixels.
override smooth_pixels: bool;
// Buffers whose sum is shown.
override layers: u32;
// The target encodes by itself.
override target_encodes: bool;

@group(0) @binding(0) var<uniform> tile: Tile;
// Bits of the numbers: NaN must be seen as such before any arithmetic touches it.
@group(0) @binding(1) var<storage, read> layer0: array<u32>;
@group(0) @binding(2) var<storage, read> layer1: array<u32>;
@group(0) @binding(3) var<storage, read> layer2: array<u32>;
@group(0) @binding(4) var<storage, read> layer3: array<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the viewport.
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

// A colour, and in w: 0 finite, 1 infinite, 2 not a number.
fn decode(bits: vec3<u32>) -> vec4<f32> {
    let magnitude = bits & vec3<u32>(0x7fffffffu);
    let nan = any(magnitude > vec3<u32>(0x7f800000u));
    let infinite = any(magnitude == vec3<u32>(0x7f800000u));
    if nan || infinite {
        return vec4<f32>(0.0, 0.0, 0.0, select(1.0, 2.0, nan));
    }
    return vec4<f32>(bitcast<vec3<f32>>(bits), 0.0);
}

fn radiance(at: vec2<i32>) -> vec4<f32> {
    let inside = clamp(at, vec2<i32>(0), vec2<i32>(tile.frame) - 1);
    let i = 3u * (u32(inside.y) * tile.frame.x + u32(inside.x));
    var sum = vec4<f32>(0.0);
    if layers > 0u {
        sum = add(sum, decode(vec3<u32>(layer0[i], layer0[i + 1u], layer0[i + 2u])));
    }
    if layers > 1u {
        sum = add(sum, decode(vec3<u32>(layer1[i], layer1[i + 1u], layer1[i + 2u])));
    }
    if layers > 2u {
        sum = add(sum, decode(vec3<u32>(layer2[i], layer2[i + 1u], layer2[i + 2u])));
    }
    if layers > 3u {
        sum = add(sum, decode(vec3<u32>(layer3[i], layer3[i + 1u], layer3[i + 2u])));
    }
    return sum;
}

fn add(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(a.xyz + b.xyz, max(a.w, b.w));
}

fn interpolated(at: vec2<f32>) -> vec4<f32> {
    let corner = floor(at - 0.5);
    let t = at - 0.5 - corner;
    let c = vec2<i32>(corner);
    let a = radiance(c);
    let b = radiance(c + vec2<i32>(1, 0));
    let d = radiance(c + vec2<i32>(0, 1));
    let e = radiance(c + vec2<i32>(1, 1));
    let bad = max(max(a.w, b.w), max(d.w, e.w));
    return vec4<f32>(mix(mix(a.xyz, b.xyz, t.x), mix(d.xyz, e.xyz, t.x), t.y), bad);
}

fn narkowicz(x: vec3<f32>) -> vec3<f32> {
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

fn agx(rgb: vec3<f32>) -> vec3<f32> {
    let inset = transpose(mat3x3<f32>(
        0.84247905, 0.0784336, 0.079223745,
        0.042328242, 0.87846864, 0.07916613,
        0.042375654, 0.0784336, 0.879143,
    ));
    let outset = transpose(mat3x3<f32>(
        1.196879, -0.09802088, -0.09902974,
        -0.05289685, 1.1519031, -0.09896118,
        -0.052971635, -0.09804345, 1.1510737,
    ));
    let lo = -12.47393;
    let hi = 4.026069;
    // log2 of 0 is not defined here; far below `lo` it does not matter.
    let stops = log2(max(inset * rgb, vec3<f32>(1e-30)));
    let x = (clamp(stops, vec3<f32>(lo), vec3<f32>(hi)) - lo) / (hi - lo);
    var y = vec3<f32>(15.5);
    y = y * x - 40.14;
    y = y * x + 31.96;
    y = y * x - 6.868;
    y = y * x + 0.4298;
    y = y * x + 0.1191;
    y = y * x - 0.00232;
    return pow(max(outset * y, vec3<f32>(0.0)), vec3<f32>(2.2));
}

// Colours of equal steps of viridis (van der Walt and Smith 2015), sRGB-encoded.
fn viridis(x: f32) -> vec3<f32> {
    var steps = array<vec3<f32>, 9>(
        vec3<f32>(0.267, 0.005, 0.329), vec3<f32>(0.279, 0.175, 0.483),
        vec3<f32>(0.230, 0.322, 0.546), vec3<f32>(0.173, 0.449, 0.558),
        vec3<f32>(0.128, 0.567, 0.551), vec3<f32>(0.158, 0.684, 0.502),
        vec3<f32>(0.369, 0.789, 0.383), vec3<f32>(0.678, 0.864, 0.190),
        vec3<f32>(0.993, 0.906, 0.144),
    );
    let at = clamp(x, 0.0, 1.0) * 8.0;
    let i = min(u32(at), 7u);
    return mix(steps[i], steps[i + 1u], at - f32(i));
}

fn srgb_encode(x: vec3<f32>) -> vec3<f32> {
    let high = 1.055 * pow(max(x, vec3<f32>(0.0031308)), vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(high, 12.92 * x, x <= vec3<f32>(0.0031308));
}

fn srgb_decode(x: vec3<f32>) -> vec3<f32> {
    let high = pow((x + 0.055) / 1.055, vec3<f32>(2.4));
    return select(high, x / 12.92, x <= vec3<f32>(0.04045));
}

// What the target shall show, from values that are sRGB-encoded already.
fn encoded(rgb: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(select(rgb, srgb_decode(rgb), target_encodes), 1.0);
}

fn linear(rgb: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(select(srgb_encode(rgb), rgb, target_encodes), 1.0);
}

// Ten stops about the middle of the display's range.
fn false_color(rgb: vec3<f32>) -> vec3<f32> {
    let luminance = dot(rgb, vec3<f32>(0.2126, 0.7152, 0.0722));
    return viridis((log2(max(luminance, 1e-30)) + 9.0) / 10.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = tile.offset + tile.scale * position.xy;
    if any(at < vec2<f32>(0.0)) || any(at >= vec2<f32>(tile.frame)) {
        return linear(vec3<f32>(tile.surround));
    }
    var pixel: vec4<f32>;
    if smooth_pixels {
        pixel = interpolated(at);
    } else {
        pixel = radiance(vec2<i32>(floor(at)));
    }
    if pixel.w > 1.5 {
        return encoded(vec3<f32>(1.0, 0.0, 1.0));
    }
    if pixel.w > 0.5 {
        return encoded(vec3<f32>(0.0, 1.0, 1.0));
    }
    // As in tonemap.rs: inputs are bounded so that squares stay finite.
    let rgb = min(max(pixel.xyz * tile.exposure, vec3<f32>(0.0)), vec3<f32>(1e9));
    switch curve {
        case 0u: { return linear(min(rgb, vec3<f32>(1.0))); }
        case 1u: { return linear(rgb / (1.0 + rgb)); }
        case 2u: { return linear(clamp(narkowicz(rgb), vec3<f32>(0.0), vec3<f32>(1.0))); }
        case 3u: { return linear(clamp(agx(rgb), vec3<f32>(0.0), vec3<f32>(1.0))); }
        default: { return encoded(false_color(rgb)); }
    }
}
