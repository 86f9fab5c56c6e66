'use strict';
// How cells, elements and triangles look: flat faces with the lines of the mesh on them.

const LIGHT_AND_LINES = `
  precision highp float;
  uniform vec3 towards; // Where the light comes from.
  uniform float shading;
  uniform vec3 ramp[9];

  vec3 alongRamp(float value) {
    float at = clamp(value, 0.0, 1.0) * 8.0;
    int low = min(int(at), 7);
    return mix(ramp[low], ramp[low + 1], at - float(low));
  }

  vec3 lit(vec3 colour, vec3 normal) {
    float facing = max(dot(normal, towards), 0.0);
    return colour * mix(1.0, 0.67 + 0.37 * facing, shading);
  }

  // Lines about one pixel wide along the sides of a face, gone where faces are tiny.
  vec3 lined(vec3 colour, vec2 at) {
    vec2 pixel = max(fwidth(at), 1e-6);
    vec2 inside = min(at, 1.0 - at) / pixel;
    float line = 1.0 - smoothstep(0.2, 1.0, min(inside.x, inside.y));
    float room = smoothstep(3.0, 9.0, 1.0 / max(pixel.x, pixel.y));
    return mix(colour, colour * 0.52, line * room * 0.8);
  }
`;

/** Return the material of the kept cells: a code and a tone for each corner. */
function cellMaterial(shape) {
  return new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3,
    side: THREE.DoubleSide,
    uniforms: {
      ...lightUniforms(),
      grid: { value: new THREE.Vector3(...shape) },
      byTone: { value: 0 },
      states: { value: [COLOURS.material, COLOURS.removed, COLOURS.filled, COLOURS.section].map(vector) },
    },
    vertexShader: `
      in uint code;
      in float tone;
      uniform vec3 grid;
      uniform vec3 states[4];
      uniform float byTone;
      out vec2 at;
      flat out vec3 normal3;
      flat out vec3 colour;
      flat out float value;

      void main() {
        uint turn = uint(gl_VertexID) & 3u;
        vec2 corner = vec2(turn == 1u || turn == 2u, turn >= 2u);
        uvec3 n = uvec3(grid);
        uint cell = code >> 5u;
        uint state = (code >> 3u) & 3u;
        uint axis = (code & 7u) >> 1u;
        float side = float(code & 1u);
        vec3 low = vec3(cell / (n.y * n.z), (cell / n.z) % n.y, cell % n.z);
        vec3 place = axis == 0u ? vec3(side, corner)
          : axis == 1u ? vec3(corner.x, side, corner.y) : vec3(corner, side);
        normal3 = vec3(axis == 0u, axis == 1u, axis == 2u) * (2.0 * side - 1.0);
        at = corner;
        colour = states[state];
        value = state == 1u || byTone < 0.5 ? -1.0 : tone;
        gl_Position = projectionMatrix * viewMatrix * vec4(low + place, 1.0);
      }`,
    fragmentShader: `${LIGHT_AND_LINES}
      in vec2 at;
      flat in vec3 normal3;
      flat in vec3 colour;
      flat in float value;
      out vec4 result;

      void main() {
        vec3 base = value < 0.0 ? colour : alongRamp(value);
        result = vec4(lined(lit(base, normal3), at), 1.0);
      }`,
  });
}

/** Return the material of elements: a place, a colour and a quality for each corner. */
function elementMaterial() {
  return new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3,
    uniforms: {
      ...lightUniforms(),
      byQuality: { value: 0 },
    },
    vertexShader: `
      in vec3 place;
      in vec3 tint;
      in float quality;
      uniform float byQuality;
      out vec2 at;
      out vec3 place3;
      flat out vec3 colour;
      flat out float value;

      void main() {
        uint turn = uint(gl_VertexID) & 3u;
        at = vec2(turn == 1u || turn == 2u, turn >= 2u);
        place3 = place;
        colour = tint;
        bool isNone = byQuality > 1.5 && quality > 0.998; // NONE in tusqh/explorer/distances.py
        value = byQuality > 0.5 && !isNone ? quality : -1.0;
        gl_Position = projectionMatrix * viewMatrix * vec4(place, 1.0);
      }`,
    fragmentShader: `${LIGHT_AND_LINES}
      uniform vec3 eye;
      in vec2 at;
      in vec3 place3;
      flat in vec3 colour;
      flat in float value;
      out vec4 result;

      void main() {
        vec3 normal3 = normalize(cross(dFdx(place3), dFdy(place3)));
        if (dot(normal3, eye) < 0.0) normal3 = -normal3;
        vec3 base = value < 0.0 ? colour : alongRamp(value);
        result = vec4(lined(lit(base, normal3), at), 1.0);
      }`,
  });
}

/** Return the material of a soup: front and back of its triangles in different colours. */
function soupMaterial() {
  return new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3,
    side: THREE.DoubleSide,
    uniforms: {
      ...lightUniforms(),
      front: { value: vector(COLOURS.front) },
      back: { value: vector(COLOURS.back) },
    },
    vertexShader: `
      out vec3 place;
      void main() {
        place = position;
        gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `${LIGHT_AND_LINES}
      uniform vec3 eye;
      uniform vec3 front;
      uniform vec3 back;
      in vec3 place;
      out vec4 result;

      void main() {
        vec3 normal3 = normalize(cross(dFdx(place), dFdy(place)));
        if (dot(normal3, eye) < 0.0) normal3 = -normal3;
        result = vec4(lit(gl_FrontFacing ? front : back, normal3), 1.0);
      }`,
  });
}

function vector(hex) { return new THREE.Vector3(...rgb(hex)); }

function lightUniforms() {
  return {
    towards: { value: new THREE.Vector3(0, 0, 1) },
    eye: { value: new THREE.Vector3(0, 0, 1) },
    shading: { value: 1 },
    ramp: { value: RAMP.map(vector) },
  };
}
