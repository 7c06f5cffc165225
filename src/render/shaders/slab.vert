// The slab's box. Far faces are drawn, so that each ray is shaded once, also when the eye is inside.
out vec3 local;

void main() {
  // gl_VertexID numbers the 36 corners of a cube's triangles: by face, then the two triangles of its square.
  int face = gl_VertexID / 6;
  int corner = gl_VertexID % 6;
  vec2 square = vec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5);
  float side = float(face % 2);
  if (side == 0.0) square = square.yx;
  int axis = face / 2;
  vec3 cube = axis == 0 ? vec3(side, square) : axis == 1 ? vec3(square.y, side, square.x) : vec3(square, side);
  local = vec3(cube.xy * size.xy, -(1.0 - cube.z) * size.w);
  gl_Position = view_projection * vec4(local, 1.0);
}
