// Copyright 2026 The reflest developers
// SPDX-License-Identifier: Apache-2.0
// node validate_gltf.js FILE: prints the report of Khronos' glTF validator as JSON.
const fs = require('fs');
const validator = require('gltf-validator');

const bytes = new Uint8Array(fs.readFileSync(process.argv[2]));
validator.validateBytes(bytes).then((report) => console.log(JSON.stringify(report.issues)));
