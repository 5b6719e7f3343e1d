// Copyright 2026 The reflest developers
// SPDX-License-Identifier: Apache-2.0
// Draws the scanned surface in WebGL 2: drag to turn, wheel to zoom, click for the material.
"use strict";

(function () {
  const data = JSON.parse(document.getElementById("model-data").textContent);
  const canvas = document.getElementById("model");
  const select = document.getElementById("mode");
  const legend = document.getElementById("legend");
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    legend.textContent = "This browser has no WebGL 2, so the model cannot be drawn.";
    return;
  }

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const positions = new Uint16Array(bytes(data.positions).buffer);
  const faces = new Uint32Array(bytes(data.faces).buffer);

  // Radiance along the mirrored direction, from a level of the light that is about as wide as the
  // Ward lobe: an approximation of the integral that the estimates were made with.
  const vertexShader = `#version 300 es
    in vec3 position; in vec3 normal; in vec3 colour; in float material;
    uniform mat4 toClip; uniform vec3 middle; uniform float step;
    out vec3 place; out vec3 facing; out vec3 tint; flat out int which;
    void main() {
      place = (position - middle) * step;
      facing = normal; tint = colour; which = int(material + 0.5);
      gl_Position = toClip * vec4(place, 1.0);
    }`;
  const fragmentShader = `#version 300 es
    precision highp float;
    in vec3 place; in vec3 facing; in vec3 tint; flat in int which;
    uniform sampler2D light; uniform sampler2D gloss;
    uniform vec3 eye; uniform int kind; uniform float lightRows;
    out vec4 shown;
    vec3 toLinear(vec3 c) {
      return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
    }
    vec3 encoded(vec3 c) {
      c = clamp(c, 0.0, 1.0);
      return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
    }
    void main() {
      if (kind == 2) { shown = vec4(float(which) / 255.0, 0.0, 0.0, 1.0); return; }
      if (kind == 1) { shown = vec4(tint, 1.0); return; }
      vec3 n = normalize(facing), o = normalize(eye - place);
      vec3 sent = toLinear(tint);
      float cosine = dot(n, o);
      if (which > 0 && cosine > 0.0) {
        vec2 found = texelFetch(gloss, ivec2(which - 1, 0), 0).rg;
        vec3 d = reflect(-o, n);
        vec2 uv = vec2(0.5 - atan(d.y, d.x) / 6.2831853, acos(clamp(d.z, -1.0, 1.0)) / 3.1415927);
        float level = log2(max(4.0 * found.y * lightRows / 3.1415927, 1.0));
        sent += found.x * textureLod(light, uv, level).rgb;
      }
      shown = vec4(encoded(sent), 1.0);
    }`;

  function compiled(kind, source) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
      throw new Error(gl.getShaderInfoLog(shader));
    }
    return shader;
  }

  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, vertexShader));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, fragmentShader));
  gl.linkProgram(program);
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);

  function attribute(name, array, size, type, normalised) {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
    const place = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, type, normalised, 0, 0);
    return buffer;
  }
  attribute("position", positions, 3, gl.UNSIGNED_SHORT, false);
  attribute("normal", new Int8Array(bytes(data.normals).buffer), 3, gl.BYTE, true);
  attribute("material", bytes(data.materials), 1, gl.UNSIGNED_BYTE, false);
  const tints = attribute("colour", bytes(data.diffuse), 3, gl.UNSIGNED_BYTE, true);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);

  function lightTexture() {
    const stored = bytes(data.light);
    const radiance = new Float32Array((stored.length / 4) * 3);
    for (let i = 0; i < stored.length / 4; i++) {
      for (let k = 0; k < 3; k++) {
        const root = (stored[4 * i + k] / 255) * (stored[4 * i + 3] / 255);
        radiance[3 * i + k] = root * root * data.brightest;
      }
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    const rows = data.lightRows;
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16F, 2 * rows, rows, 0, gl.RGB, gl.FLOAT, radiance);
    // RGB16F can be filtered but not rendered to, so that the levels are averaged here.
    let width = 2 * rows, height = rows, level = radiance;
    for (let index = 1; width > 1 || height > 1; index++) {
      const half = Math.max(width >> 1, 1), low = Math.max(height >> 1, 1);
      const next = new Float32Array(half * low * 3);
      for (let y = 0; y < low; y++) {
        for (let x = 0; x < half; x++) {
          for (let k = 0; k < 3; k++) {
            let sum = 0;
            for (let corner = 0; corner < 4; corner++) {
              const column = Math.min(2 * x + (corner & 1), width - 1);
              const row = Math.min(2 * y + (corner >> 1), height - 1);
              sum += level[3 * (row * width + column) + k];
            }
            next[3 * (y * half + x) + k] = sum / 4;
          }
        }
      }
      gl.texImage2D(gl.TEXTURE_2D, index, gl.RGB16F, half, low, 0, gl.RGB, gl.FLOAT, next);
      width = half; height = low; level = next;
    }
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  }
  lightTexture();

  gl.activeTexture(gl.TEXTURE1);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  const values = new Float32Array(data.gloss.flatMap(([, rhoS, alpha]) => [rhoS, alpha]));
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32F, data.gloss.length, 1, 0, gl.RG, gl.FLOAT, values);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);

  const uniform = (name) => gl.getUniformLocation(program, name);
  gl.uniform1i(uniform("light"), 0);
  gl.uniform1i(uniform("gloss"), 1);
  gl.uniform1f(uniform("lightRows"), data.lightRows);
  gl.uniform3fv(uniform("middle"), data.middle);
  gl.uniform1f(uniform("step"), data.step);

  const reach = Math.hypot(...data.middle) * data.step;
  const view = { azimuth: data.azimuth, rise: data.rise, distance: 2.1 * reach };
  let mode = 0;

  function eye() {
    const flat = view.distance * Math.cos(view.rise);
    return [
      flat * Math.cos(view.azimuth),
      flat * Math.sin(view.azimuth),
      view.distance * Math.sin(view.rise),
    ];
  }

  // Column by column: perspective times the camera's turn and place.
  function toClip(width, height) {
    const [x, y, z] = eye();
    const back = [x, y, z].map((one) => one / view.distance);
    const right = [-Math.sin(view.azimuth), Math.cos(view.azimuth), 0];
    const up = [
      back[1] * right[2] - back[2] * right[1],
      back[2] * right[0] - back[0] * right[2],
      back[0] * right[1] - back[1] * right[0],
    ];
    const scale = 1 / Math.tan(0.38);
    const near = 0.05 * view.distance, far = view.distance + 4 * reach;
    const a = -(far + near) / (far - near), b = (-2 * far * near) / (far - near);
    const wide = (scale * height) / width;
    const matrix = [];
    for (let k = 0; k < 3; k++) {
      matrix.push(wide * right[k], scale * up[k], a * back[k], -back[k]);
    }
    matrix.push(0, 0, -a * view.distance + b, view.distance);
    return matrix;
  }

  function draw(kind) {
    const density = window.devicePixelRatio || 1;
    const width = Math.round(canvas.clientWidth * density);
    const height = Math.round(canvas.clientHeight * density);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, kind === 2 ? 1 : 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(uniform("toClip"), false, toClip(width, height));
    gl.uniform3fv(uniform("eye"), eye());
    gl.uniform1i(uniform("kind"), kind);
    gl.drawElements(gl.TRIANGLES, faces.length, gl.UNSIGNED_INT, 0);
  }
  const redraw = () => draw(mode === 0 ? 0 : 1);

  function choose(index) {
    mode = index;
    const chosen = mode === 0 ? null : data.modes[mode - 1];
    gl.bindBuffer(gl.ARRAY_BUFFER, tints);
    gl.bufferData(gl.ARRAY_BUFFER, bytes(chosen ? chosen.colours : data.diffuse), gl.STATIC_DRAW);
    legend.innerHTML = chosen ? chosen.legend : "The materials in the light of the scan.";
    redraw();
  }
  for (const name of ["Materials in the light", ...data.modes.map((one) => one.name)]) {
    select.add(new Option(name));
  }
  select.addEventListener("change", () => choose(select.selectedIndex));

  function materialAt(event) {
    const box = canvas.getBoundingClientRect();
    draw(2);
    const pixel = new Uint8Array(4);
    const x = ((event.clientX - box.left) / box.width) * canvas.width;
    const y = (1 - (event.clientY - box.top) / box.height) * canvas.height;
    gl.readPixels(Math.floor(x), Math.floor(y), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    redraw();
    return pixel[0] ? data.gloss[pixel[0] - 1][0] : null;
  }

  let moved = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    moved = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    moved += Math.abs(event.movementX) + Math.abs(event.movementY);
    view.azimuth -= 0.008 * event.movementX;
    view.rise = Math.min(Math.max(view.rise + 0.008 * event.movementY, -1.5), 1.5);
    redraw();
  });
  canvas.addEventListener("pointerup", (event) => {
    if (moved > 4) return;
    const id = materialAt(event);
    for (const row of document.querySelectorAll("tr[data-material]")) {
      row.classList.toggle("chosen", row.dataset.material === String(id));
    }
    const chosen = document.querySelector("tr.chosen");
    if (chosen) chosen.scrollIntoView({ block: "nearest", behavior: "smooth" });
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const factor = Math.exp(0.001 * event.deltaY);
    view.distance = Math.min(Math.max(view.distance * factor, 0.3 * reach), 8 * reach);
    redraw();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (!(event.key in turn)) return;
    event.preventDefault();
    view.azimuth += turn[event.key][0];
    view.rise = Math.min(Math.max(view.rise + turn[event.key][1], -1.5), 1.5);
    redraw();
  });
  window.addEventListener("resize", redraw);
  choose(0);
})();
