// The height field: bilinear between texel centres, as surface::Surface means it. The texture has a border of one texel
// in which the surface's edge rule (wrap or clamp) is already worked out.
uniform sampler2D heights;  // metres, (texels.x + 2) x (texels.y + 2)

// Height z of the relief at local xy.
float height(vec2 p) {
  return textureLod(heights, (p / size.xy * texels.xy + 1.0) / (texels.xy + 2.0), 0.0).r;
}
