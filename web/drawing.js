// Draws triangles with WebGL 2. Positions, indices and what is known of each triangle lie in textures, so that each corner
// finds those of its triangle by its number. Lights and colours are those of the desktop viewer.
const vertexShader = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform mat4 world_to_clip;
uniform vec3 origin;
uniform sampler2D positions;
uniform sampler2D colors;
uniform usampler2D indices;
uniform usampler2D seen;
uniform int color_mode;
out vec3 position;
flat out vec3 color;
out vec3 barycentric;
const vec3 of_seen[4] = vec3[4](vec3(238, 174, 92), vec3(62, 96, 158), vec3(128, 92, 148), vec3(112, 118, 126));
ivec2 place(int i) { return ivec2(i & 2047, i >> 11); }
void main() {
  int triangle = gl_VertexID / 3;
  int corner = gl_VertexID - 3 * triangle;
  int vertex = int(texelFetch(indices, place(gl_VertexID), 0).r);
  position = texelFetch(positions, place(vertex), 0).xyz + origin;
  barycentric = vec3(corner == 0, corner == 1, corner == 2);
  vec3 srgb = color_mode == 2 ? of_seen[texelFetch(seen, place(triangle), 0).r] / 255.0 : texelFetch(colors, place(vertex), 0).rgb;
  color = color_mode == 0 ? vec3(0.80, 0.70, 0.58) : srgb * srgb;
  gl_Position = world_to_clip * vec4(position, 1.0);
}`;

const fragmentShader = `#version 300 es
precision highp float;
uniform vec3 eye;
uniform vec3 key_light;
uniform vec3 up;
uniform bool wires;
in vec3 position;
flat in vec3 color;
in vec3 barycentric;
out vec4 target;
void main() {
  vec3 to_eye = normalize(eye - position);
  vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
  if (dot(normal, to_eye) < 0.0) normal = -normal;
  float head = max(dot(normal, to_eye), 0.0);
  float key = max(dot(normal, key_light), 0.0);
  vec3 light = 0.12 * head + 0.98 * key * vec3(1.0, 0.94, 0.84) + mix(vec3(0.045, 0.036, 0.034), vec3(0.12, 0.15, 0.20), 0.5 + 0.5 * dot(normal, up));
  vec3 lit = color * light;
  if (wires) {
    vec3 distances = barycentric / fwidth(barycentric);
    float line = 1.0 - smoothstep(0.4, 1.3, min(distances.x, min(distances.y, distances.z)));
    lit = mix(lit, vec3(0.03), 0.6 * line);
  }
  target = vec4(sqrt(lit), 1.0);
}`;

const lineShader = `#version 300 es
uniform mat4 world_to_clip;
in vec3 corner;
void main() { gl_Position = world_to_clip * vec4(corner, 1.0); }`;

const lineColor = `#version 300 es
precision mediump float;
out vec4 target;
void main() { target = vec4(1.0, 0.85, 0.2, 1.0); }`;

const width = 2048; // texels in a row

export class Drawing {
  #gl;
  #mesh;
  #lines;
  #textures = {};
  #triangles = 0;
  #hasColors = false;

  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("this browser has no WebGL 2; use another one, or switch on its graphics acceleration");
    this.#gl = gl;
    this.#mesh = this.#program(vertexShader, fragmentShader);
    this.#lines = { ...this.#program(lineShader, lineColor), buffer: gl.createBuffer() };
    gl.enable(gl.DEPTH_TEST);
  }

  #program(...sources) {
    const gl = this.#gl;
    const program = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, i) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, sources[i]);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(`the shaders do not compile: ${gl.getProgramInfoLog(program)}; ${gl.getAttachedShaders(program).map((s) => gl.getShaderInfoLog(s))}`);
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const { name } = gl.getActiveUniform(program, i);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    return { program, uniforms };
  }

  // Stores elements of `size` numbers in the texture of a name.
  #store(name, data, size, internal, format, type) {
    const gl = this.#gl;
    const elements = data.length / size;
    const rows = Math.max(1, Math.ceil(elements / width));
    if (rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error("this mesh has more than WebGL can hold; use the desktop viewer");
    let held = this.#textures[name];
    if (!held || held.rows < rows) {
      gl.deleteTexture(held?.texture ?? null);
      held = this.#textures[name] = { texture: gl.createTexture(), rows };
      gl.bindTexture(gl.TEXTURE_2D, held.texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, internal, width, rows);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    }
    gl.bindTexture(gl.TEXTURE_2D, held.texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const whole = Math.floor(elements / width);
    if (whole) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, whole, format, type, data.subarray(0, whole * width * size));
    const rest = elements - whole * width;
    if (rest) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, whole, rest, 1, format, type, data.subarray(whole * width * size));
  }

  setVertices(positions, colors) {
    const gl = this.#gl;
    this.#store("positions", positions, 3, gl.RGB32F, gl.RGB, gl.FLOAT);
    this.#hasColors = colors.length > 0;
    this.#store("colors", this.#hasColors ? colors : new Uint8Array(4), 4, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE);
    this.#triangles = 0;
  }

  setTriangles(triangles, seen) {
    const gl = this.#gl;
    this.#store("indices", triangles, 1, gl.R32UI, gl.RED_INTEGER, gl.UNSIGNED_INT);
    this.#store("seen", seen ?? new Uint8Array(1), 1, gl.R8UI, gl.RED_INTEGER, gl.UNSIGNED_BYTE);
    this.#triangles = triangles.length / 3;
  }

  // `view`: world_to_clip, eye, key_light, up; `frozen`: eight corners of a frustum, or nothing.
  draw(view, { origin, colorBySeen, wires, frozen }) {
    const gl = this.#gl;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(0.77, 0.8, 0.84, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.#triangles) return;
    const { program, uniforms } = this.#mesh;
    gl.useProgram(program);
    gl.bindVertexArray(null);
    gl.uniformMatrix4fv(uniforms.world_to_clip, false, view.worldToClip);
    gl.uniform3fv(uniforms.origin, origin);
    gl.uniform3fv(uniforms.eye, view.eye);
    gl.uniform3fv(uniforms.key_light, view.keyLight);
    gl.uniform3fv(uniforms.up, view.up);
    gl.uniform1i(uniforms.color_mode, colorBySeen ? 2 : this.#hasColors ? 1 : 0);
    gl.uniform1i(uniforms.wires, wires);
    ["positions", "colors", "indices", "seen"].forEach((name, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, this.#textures[name].texture);
      gl.uniform1i(uniforms[name], unit);
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3 * this.#triangles);
    if (frozen) this.#drawFrustum(view, frozen);
  }

  #drawFrustum(view, corners) {
    const gl = this.#gl;
    const edges = [0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7, 7, 6, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7];
    gl.useProgram(this.#lines.program);
    gl.uniformMatrix4fv(this.#lines.uniforms.world_to_clip, false, view.worldToClip);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#lines.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(edges.flatMap((i) => corners[i])), gl.STREAM_DRAW);
    const corner = gl.getAttribLocation(this.#lines.program, "corner");
    gl.enableVertexAttribArray(corner);
    gl.vertexAttribPointer(corner, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.LINES, 0, edges.length);
    gl.disableVertexAttribArray(corner);
  }
}
