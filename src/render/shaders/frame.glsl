// The uniform block shared by all shaders; FrameBlock in programs.h mirrors it. All in the surface's local frame:
// metres along (t, b, n) from the corner u = v = 0, the base plane at z = 0 and the relief at z = -depth.
precision highp float;
precision highp int;
precision highp sampler2D;

const int MAX_BALLS = 32;

layout(std140) uniform Frame {
  mat4 view_projection;
  vec4 eye;             // xyz; w: angle of one sample, radians
  vec4 light;           // xyz: unit direction to the sun (w = 0) or the lamp's position (w = 1)
  vec4 light_colour;    // rgb; w: tangent of the light's angular radius
  vec4 sky;             // rgb
  vec4 ground;          // rgb
  vec4 size;            // xy: the rectangle; z: maximum depth of the relief; w: thickness of the slab
  vec4 texels;          // xy: texels along u and v; z: the smaller texel in metres; w: 1 if there is a colour map
  vec4 material;        // rgb: colour without a colour map; w: roughness
  ivec4 steps;          // linear, binary, shadow steps; w: levels of the pyramid
  ivec4 count;          // x: balls that cast shadows; y: pens (0 or 1); z: representation (0 flat, 1 normal, 2 relief);
                        // w: coarsest level of heights that a sample may use
  vec4 pen_tip;         // xyz; w: radius of the shaft
  vec4 pen_direction;   // xyz, unit; w: length
  vec4 pen_cone;        // x: length of the cone
  vec4 ball[MAX_BALLS]; // xyz: centre; w: radius
};

vec3 to_light(vec3 p) { return light.w == 0.0 ? light.xyz : normalize(light.xyz - p); }

float window_depth(vec3 p) {
  vec4 clip = view_projection * vec4(p, 1.0);
  return 0.5 + 0.5 * clip.z / clip.w;
}
