// An instance is one tetrahedron of the layer of a curved base; gl_VertexID numbers its twelve corners. Far faces are
// drawn, so that each ray is shaded once, also when the eye is inside.
uniform mat4 model;  // of the base, rigid

layout(location = 0) in vec3 corner0;
layout(location = 1) in vec3 corner1;
layout(location = 2) in vec3 corner2;
layout(location = 3) in vec3 corner3;
layout(location = 4) in vec3 texture0;
layout(location = 5) in vec3 texture1;
layout(location = 6) in vec3 texture2;
layout(location = 7) in vec3 texture3;

out vec3 local;
flat out vec4 eye_weights;  // barycentric coordinates of the eye
flat out vec3 slope0, slope1, slope2, slope3;  // of the four coordinates
flat out vec3 eye_texture;  // the eye in the texture: metres along u, v and the height
flat out mat3 to_texture;   // of directions

vec3 placed(vec3 p) { return (model * vec4(p, 1.0)).xyz; }

void main() {
  vec3 c[4] = vec3[4](placed(corner0), placed(corner1), placed(corner2), placed(corner3));
  const int order[12] = int[12](0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3);
  vec3 a = c[1] - c[0], b = c[2] - c[0], d = c[3] - c[0];
  float volume = dot(a, cross(b, d));
  slope1 = cross(b, d) / volume;
  slope2 = cross(d, a) / volume;
  slope3 = cross(a, b) / volume;
  slope0 = -(slope1 + slope2 + slope3);
  vec3 from = eye.xyz - c[0];
  eye_weights.yzw = vec3(dot(slope1, from), dot(slope2, from), dot(slope3, from));
  eye_weights.x = 1.0 - eye_weights.y - eye_weights.z - eye_weights.w;
  vec3 tu = texture1 - texture0, tv = texture2 - texture0, tw = texture3 - texture0;
  eye_texture = texture0 + eye_weights.y * tu + eye_weights.z * tv + eye_weights.w * tw;
  to_texture = outerProduct(tu, slope1) + outerProduct(tv, slope2) + outerProduct(tw, slope3);
  local = c[order[gl_VertexID]];
  gl_Position = view_projection * vec4(local, 1.0);
}
