// Samples to pixels: the mean of each pixel's SUPERSAMPLE x SUPERSAMPLE samples, in linear light, over the background;
// then sRGB, top row first.
precision highp float;
precision highp sampler2D;

uniform sampler2D samples;  // rgb times coverage, coverage; SUPERSAMPLE x SUPERSAMPLE a pixel
uniform vec3 background_top;
uniform vec3 background_bottom;

layout(location = 0) out vec4 out_colour;

vec3 to_srgb(vec3 x) {
  return mix(12.92 * x, 1.055 * pow(max(x, 1e-6), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x));
}

// Bayer's 4 x 4 threshold, -0.5..0.5: breaks up the bands that 8 bits would show in a dark gradient.
float threshold(ivec2 p) {
  int x = p.x ^ p.y;
  int m = ((x & 1) << 3) | ((p.y & 1) << 2) | (x & 2) | ((p.y & 2) >> 1);
  return (float(m) + 0.5) / 16.0 - 0.5;
}

void main() {
  ivec2 size = textureSize(samples, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 first = ivec2(pixel.x, size.y / SUPERSAMPLE - 1 - pixel.y) * SUPERSAMPLE;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < SUPERSAMPLE; ++y) {
    for (int x = 0; x < SUPERSAMPLE; ++x) sum += texelFetch(samples, first + ivec2(x, y), 0);
  }
  sum /= float(SUPERSAMPLE * SUPERSAMPLE);
  vec2 place = (vec2(first) + 0.5 * float(SUPERSAMPLE)) / vec2(size);
  float vignette = 1.0 - 0.35 * dot(place - 0.5, place - 0.5) * 2.0;
  vec3 background = mix(background_bottom, background_top, smoothstep(0.0, 1.0, place.y)) * vignette;
  vec3 linear = sum.rgb + (1.0 - sum.a) * background;
  out_colour = vec4(to_srgb(linear) + threshold(pixel) / 255.0, 1.0);
}
