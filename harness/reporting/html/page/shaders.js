// The GLSL programs of the 3D view.

const HEADER = "#version 300 es\nprecision highp float;\n";

/** Lit surfaces: sky light from above, one sun with a soft shadow, a grid on floors. */
export const SURFACE = {
  vertex: `${HEADER}
layout(location=0) in vec3 position;
layout(location=1) in vec3 normal;
uniform mat4 model, view, sun;
out vec3 world, worldNormal;
out vec4 inSun;
void main() {
  vec4 p = model * vec4(position, 1.0);
  world = p.xyz;
  worldNormal = mat3(model) * normal;
  inSun = sun * vec4(p.xyz + normalize(worldNormal) * 0.004, 1.0);
  gl_Position = view * p;
}`,
  fragment: `${HEADER}
in vec3 world, worldNormal;
in vec4 inSun;
uniform vec4 color, fog;
uniform vec3 eye, sunDirection, gridCenter;
uniform float grid, glow, ambient, outline;
uniform highp sampler2DShadow shadowMap;
out vec4 result;

float sunlight() {
  vec3 place = inSun.xyz / inSun.w * 0.5 + 0.5;
  if (any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0)))) return 1.0;
  float lit = 0.0;
  for (int i = -1; i <= 1; i++)
    for (int j = -1; j <= 1; j++)
      lit += texture(shadowMap, vec3(place.xy + vec2(i, j) * 1.4 / 2048.0, place.z - 0.0012));
  return lit / 9.0;
}

float lines(vec2 place, float width) {
  vec2 distance = abs(fract(place - 0.5) - 0.5) / fwidth(place);
  return 1.0 - min(min(distance.x, distance.y) * width, 1.0);
}

void main() {
  vec3 toEye = normalize(eye - world), n = normalize(worldNormal);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 base = pow(color.rgb, vec3(2.2));
  float facing = max(dot(n, sunDirection), 0.0), lit = sunlight();
  vec3 sky = mix(vec3(0.26, 0.26, 0.28), vec3(0.52, 0.54, 0.58), n.z * 0.5 + 0.5) * ambient;
  float shine = pow(max(dot(n, normalize(sunDirection + toEye)), 0.0), 48.0) * 0.20 * lit * facing;
  float rim = pow(1.0 - max(dot(n, toEye), 0.0), 3.0) * outline;
  vec3 light = base * (sky + vec3(1.05, 1.02, 0.97) * facing * lit) + shine + rim * sky;
  light += glow * vec3(0.55, 0.10, 0.02);
  float alpha = color.a;
  if (grid > 0.0) {
    float far = distance(world.xy, gridCenter.xy);
    float fine = lines(world.xy * 10.0, 1.0) * 0.45 * exp(-far * far * 0.25);
    float coarse = lines(world.xy, 0.6) * 0.7 * exp(-far * far * 0.06);
    light = mix(light, light * 0.72, max(fine, coarse));
    light = mix(light, pow(fog.rgb, vec3(2.2)), smoothstep(1.6, 5.0, far));
  }
  light = light / (1.0 + max(light - 0.75, 0.0) * 0.6);
  result = vec4(pow(light, vec3(1.0 / 2.2)), alpha);
}`,
};

/** Depth as the sun sees it, or a plain colour for each body as the eye does. */
export const SHADOW = {
  vertex: `${HEADER}
layout(location=0) in vec3 position;
uniform mat4 model, sun;
void main() { gl_Position = sun * model * vec4(position, 1.0); }`,
  fragment: `${HEADER}
uniform vec4 color;
out vec4 result;
void main() { result = color; }`,
};

/** Lines of a width in pixels: each segment is two triangles that face the screen. */
export const LINE = {
  vertex: `${HEADER}
layout(location=0) in vec3 from;
layout(location=1) in vec3 to;
layout(location=2) in vec2 corner;
layout(location=3) in float along;
uniform mat4 view, model;
uniform vec2 resolution;
uniform float width;
out float length;
void main() {
  vec4 p = view * model * vec4(from, 1.0), q = view * model * vec4(to, 1.0);
  vec2 direction = normalize((q.xy / q.w - p.xy / p.w) * resolution + 1e-6);
  vec4 place = corner.x < 0.5 ? p : q;
  place.xy += (vec2(-direction.y, direction.x) * corner.y + direction * (corner.x * 2.0 - 1.0) * 0.4)
    * width / resolution * place.w;
  length = along;
  gl_Position = place;
}`,
  fragment: `${HEADER}
in float length;
uniform vec4 color;
uniform float dash;
out vec4 result;
void main() {
  if (dash > 0.0 && fract(length / dash) > 0.55) discard;
  result = color;
}`,
};

/** The sky: from the horizon's colour to the one above. */
export const SKY = {
  vertex: `${HEADER}
out float height;
void main() {
  vec2 place = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  height = place.y;
  gl_Position = vec4(place, 0.999, 1.0);
}`,
  fragment: `${HEADER}
in float height;
uniform vec3 low, high;
uniform float horizon;
out vec4 result;
void main() { result = vec4(mix(low, high, smoothstep(0.0, 1.6, height - horizon)), 1.0); }`,
};
