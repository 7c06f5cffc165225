// The height field: bilinear between texel centres, as in surface::Surface, and its coarser fields (HeightLevels in
// surface_textures.h). Vertex (0, 0) is texel (-1, -1): a border of one texel applies the edge rule (wrap or clamp).
uniform sampler2D heights;  // depth / maximum depth; vertex (i, j) of level k is vertex (i, j) * 2^k of level 0

// The level that this sample uses: 0 is the surface itself.
int detail = 0;

// The level for a sample of that footprint, metres: the coarsest whose cells are at most half of it. Cells as large as
// samples would blur steps visibly (tests/render/test_detail.cpp, pictures of the scenes).
int detail_for(float footprint) { return min(int(log2(max(0.5 * footprint / texels.z, 1.0))), count.w); }

// The side of a cell of that level, in texels.
float cell_side(int level) { return float(1 << level); }

float height_at(vec2 p, int level) {
  vec2 vertex = p / size.xy * texels.xy + 0.5;
  return -size.z * textureLod(heights, (vertex + 0.5 * cell_side(level)) / vec2(textureSize(heights, 0)), float(level)).r;
}

// Height z of the relief at local xy.
float height(vec2 p) { return height_at(p, detail); }

// The mean height about p, over a square of `width` metres.
float mean_height(vec2 p, float width) { return height_at(p, int(max(log2(width / texels.z), 0.0) + 0.5)); }
