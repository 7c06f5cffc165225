// The height field: bilinear between texel centres, as surface::Surface means it. The texture has a border of one texel
// in which the surface's edge rule (wrap or clamp) is already worked out.
uniform sampler2D heights;  // depth as a fraction of the greatest, (texels.x + 2) x (texels.y + 2), mipmapped

// Height z of the relief at local xy.
float height(vec2 p) {
  return -size.z * textureLod(heights, (p / size.xy * texels.xy + 1.0) / (texels.xy + 2.0), 0.0).r;
}

// The mean height about p, over a square of `width` metres.
float mean_height(vec2 p, float width) {
  float level = max(log2(width / texels.z), 0.0);
  return -size.z * textureLod(heights, (p / size.xy * texels.xy + 1.0) / (texels.xy + 2.0), level).r;
}
