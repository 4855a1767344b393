// Runs each recording on this browser's GPU and compares what comes back with what texbake's CPU reference answered.
// A recording (src/backend/gpu/recording.rs) is one computation as data: kernels, parameters, inputs, expected outputs.
"use strict";

// What stands in every byte of the outputs before a case: -6328 or -5.8 of floats, far from every answer.
const POISON = 0xc5;

// Room for the parameters of any kernel, as texbake has it.
const PARAMS_BYTES = 256;

// A case that has not answered for so long will not.
const PATIENCE_SECONDS = 120;

// Differing cases that are shown in full; the report has all of them.
const SHOWN_PROBLEMS = 30;

// Cases whose kernels are compiled while another one runs: browsers compile on several threads.
const CASES_AHEAD = 4;

// The tab stays usable if no turn of ours is longer.
const TURN_MILLISECONDS = 40;

addEventListener("load", () => verify().catch(showBroken));

async function verify() {
    const { notes, kernels, cases } = JSON.parse(element("recordings").textContent);
    const started = performance.now();
    const results = [];
    const rows = showPlannedRows(cases.map(withKernelNames(kernels)));
    showKernels(kernels);

    const gpu = await openGpu(kernels).catch((error) => ({ unusable: messageOf(error) }));
    showDevice(notes, gpu);
    for (const [number, recording] of cases.entries()) {
        showProgress(number, cases.length, recording.name);
        compileAhead(gpu, cases.slice(number + 1, number + 1 + CASES_AHEAD));
        const result = gpu.unusable ? failed(recording, gpu.unusable) : await resultOf(gpu, recording);
        results.push(result);
        rows.get(recording).add(result);
        await nextTurn();
    }

    const report = reportOf(notes, gpu, results, performance.now() - started);
    showVerdict(report);
    showProblems(results, gpu.unusable);
    offerReport(report);
    tellAutomation(report);
}

// ---------------------------------------------------------------------------------------------------------------------
// The GPU
// ---------------------------------------------------------------------------------------------------------------------

// The device that this browser offers, with a way to compile kernels on it; throws words that say what to do.
async function openGpu(kernels) {
    if (!navigator.gpu) {
        throw new Error(wordsForNoWebGpu());
    }
    const adapter = await navigator.gpu.requestAdapter();
    if (!adapter) {
        throw new Error(
            "This browser has WebGPU, but offers no GPU for it. Update the graphics driver, switch on the browser's " +
                "hardware acceleration, or start Chromium with --enable-unsafe-webgpu " +
                "--use-webgpu-adapter=swiftshader to compute in software.",
        );
    }
    const device = await adapter.requestDevice();
    const info = adapter.info ?? {};
    const gpu = { adapter, info, device, lost: null, kernels, modules: new Map(), pipelines: new Map(), compiled: [] };
    gpu.loss = device.lost.then(({ reason, message }) => {
        gpu.lost = `The device was lost: ${message || reason}`;
        throw new Error(gpu.lost);
    });
    gpu.loss.catch(() => {});
    device.addEventListener("uncapturederror", ({ error }) => (gpu.stray = error.message));
    gpu.layout = device.createBindGroupLayout({
        entries: ["uniform", "read-only-storage", "storage"].map((type, binding) => ({
            binding,
            visibility: GPUShaderStage.COMPUTE,
            buffer: { type },
        })),
    });
    return gpu;
}

function wordsForNoWebGpu() {
    const where = isSecureContext
        ? "Open this page in Chrome or Edge 113, Safari 26, Firefox 141 or newer; on Linux, Chrome may need " +
          "chrome://flags/#enable-unsafe-webgpu, and Firefox dom.webgpu.enabled in about:config."
        : "Browsers offer it to pages that come from a file, from localhost or by https: open this page like that.";
    return `This browser offers no WebGPU to this page, so nothing was compared. ${where}`;
}

// The compiled kernel of a pass; compiled once for each choice of constants.
function pipelineOf(gpu, { kernel, constants }) {
    const key = `${kernel} ${JSON.stringify(constants)}`;
    if (!gpu.pipelines.has(key)) {
        gpu.pipelines.set(key, compile(gpu, kernel, constants));
    }
    return gpu.pipelines.get(key);
}

function compileAhead(gpu, cases) {
    if (gpu.unusable || gpu.lost) {
        return;
    }
    // What fails here fails again when its case is run.
    cases.flatMap(({ passes }) => passes).forEach((pass) => pipelineOf(gpu, pass).catch(() => {}));
}

async function compile(gpu, kernel, constants) {
    const { name, entry_point: entryPoint } = gpu.kernels[kernel];
    const started = performance.now();
    const module = await moduleOf(gpu, kernel);
    const layout = gpu.device.createPipelineLayout({ bindGroupLayouts: [gpu.layout] });
    try {
        return await gpu.device.createComputePipelineAsync({ layout, compute: { module, entryPoint, constants } });
    } catch (error) {
        throw new Error(`The kernel "${name}" does not compile: ${messageOf(error)}`);
    } finally {
        gpu.compiled.push({ kernel: name, constants, milliseconds: Math.round(performance.now() - started) });
    }
}

function moduleOf(gpu, kernel) {
    if (!gpu.modules.has(kernel)) {
        gpu.modules.set(kernel, parse(gpu, gpu.kernels[kernel]));
    }
    return gpu.modules.get(kernel);
}

async function parse({ device }, { name, text }) {
    device.pushErrorScope("validation");
    const module = device.createShaderModule({ label: name, code: text });
    const error = await device.popErrorScope();
    const { messages } = await module.getCompilationInfo();
    const lines = messages
        .filter(({ type }) => type === "error")
        .map(({ lineNum, linePos, message }) => `line ${lineNum}, column ${linePos}: ${message}`);
    if (lines.length > 0 || error) {
        throw new Error(`The kernel "${name}" is refused: ${lines.join("; ") || error.message}`);
    }
    return module;
}

// The bytes that a recording's passes leave in the outputs.
async function outputsOf(gpu, recording) {
    const { device, layout } = gpu;
    const pipelines = await Promise.all(recording.passes.map((pass) => pipelineOf(gpu, pass)));
    for (const filter of ["internal", "out-of-memory", "validation"]) {
        device.pushErrorScope(filter);
    }
    const outputBytes = 4 * recording.output_words;
    const { STORAGE, UNIFORM, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
    const inputs = bufferWith(device, bytesOf(recording.inputs), STORAGE);
    const outputs = bufferWith(device, new Uint8Array(outputBytes).fill(POISON), STORAGE | COPY_SRC);
    const download = device.createBuffer({ size: outputBytes, usage: MAP_READ | COPY_DST });
    const params = recording.passes.map((pass) => bufferWith(device, bytesOf(pass.params), UNIFORM, PARAMS_BYTES));

    const encoder = device.createCommandEncoder();
    recording.passes.forEach((pass, number) => {
        const bound = [params[number], inputs, outputs];
        const entries = bound.map((buffer, binding) => ({ binding, resource: { buffer } }));
        const compute = encoder.beginComputePass();
        compute.setPipeline(pipelines[number]);
        compute.setBindGroup(0, device.createBindGroup({ layout, entries }));
        compute.dispatchWorkgroups(...pass.groups);
        compute.end();
    });
    encoder.copyBufferToBuffer(outputs, 0, download, 0, outputBytes);
    device.queue.submit([encoder.finish()]);

    const errors = await Promise.all([1, 2, 3].map(() => device.popErrorScope()));
    const error = errors.find((error) => error !== null);
    if (error) {
        throw new Error(`The device refuses: ${error.message}`);
    }
    await download.mapAsync(GPUMapMode.READ);
    const bytes = new Uint8Array(download.getMappedRange().slice(0));
    [inputs, outputs, download, ...params].forEach((buffer) => buffer.destroy());
    return bytes;
}

function bufferWith(device, bytes, usage, least = 4) {
    const size = Math.max(least, bytes.length);
    const buffer = device.createBuffer({ size, usage, mappedAtCreation: true });
    new Uint8Array(buffer.getMappedRange()).set(bytes);
    buffer.unmap();
    return buffer;
}

// ---------------------------------------------------------------------------------------------------------------------
// The comparison
// ---------------------------------------------------------------------------------------------------------------------

async function resultOf(gpu, recording) {
    try {
        if (gpu.lost) {
            throw new Error(gpu.lost);
        }
        const answer = Promise.race([outputsOf(gpu, recording), gpu.loss]);
        const outputs = await withPatience(answer);
        if (gpu.stray) {
            throw new Error(`The device reports: ${gpu.stray}`);
        }
        return compared(recording, outputs);
    } catch (error) {
        return failed(recording, gpu.lost ?? messageOf(error));
    }
}

function failed(recording, message) {
    return { ...outlineOf(recording), result: "failed", values: 0, differences: 0, message };
}

function outlineOf({ name, operation, kernel, precision, formats }) {
    return { name, operation, kernel, precision, formats };
}

// Compares all maps of a recording; one that holds no value has proved nothing.
function compared(recording, outputs) {
    const maps = recording.expected.map((expected) => comparedMap(expected, outputs));
    const sum = (of) => maps.reduce((total, map) => total + of(map), 0);
    const values = sum((map) => map.values);
    const differences = sum((map) => map.differences);
    if (maps.some((map) => map.values === 0) || maps.length === 0) {
        return failed(recording, "Nothing was compared.");
    }
    const worst = maps.find((map) => map.first);
    return {
        ...outlineOf(recording),
        result: differences === 0 ? "agrees" : "differs",
        values,
        differences,
        largest: largestOf(maps.map((map) => map.largest)),
        first: worst && { ...worst.first, from: inputsAround(recording, worst.first) },
    };
}

// Compares the rows of one map with what is expected there.
function comparedMap(expected, outputs) {
    const code = CODES[expected.code];
    const [right, got] = [bytesOf(expected.bytes), rowsIn(outputs, expected)];
    const values = right.length / code.bytes;
    const largest = { codes: 0, ulps: 0, degrees: 0 };
    let differences = 0;
    let first = null;
    for (let index = 0; index < values; index++) {
        const [gotBits, rightBits] = [got, right].map((bytes) => bitsAt(bytes, index, code));
        if (gotBits === rightBits) {
            continue;
        }
        const error = Math.abs(code.value(gotBits) - code.value(rightBits)) * code.perUnit;
        const turned = isDirection(expected) ? degreesBetween(...[got, right].map((b) => texelAt(b, index, code))) : 0;
        if (code.unit !== null) {
            // A difference from NaN is larger than any.
            largest[code.unit] = Math.max(largest[code.unit], Number.isNaN(error) ? Infinity : error);
            largest.degrees = Math.max(largest.degrees, turned || 0);
        }
        const { tolerance } = expected;
        if (!(tolerance && error <= tolerance[code.unit] && turned <= tolerance.degrees)) {
            differences += 1;
            first ??= differenceAt(expected, index, code, gotBits, rightBits);
        }
    }
    return { values, differences, largest, first };
}

// Whether texels are directions, stored finely enough for angles to say something.
function isDirection({ code, channels }) {
    return code === "f32" && channels === 3;
}

// The three components of the texel to which a code belongs.
function texelAt(bytes, index, code) {
    const first = index - (index % 3);
    return [first, first + 1, first + 2].map((at) => code.value(bitsAt(bytes, at, code)));
}

// Zero where either has no direction.
function degreesBetween([a, b, c], [x, y, z]) {
    const across = Math.hypot(b * z - c * y, c * x - a * z, a * y - b * x);
    return (Math.atan2(across, a * x + b * y + c * z) * 180) / Math.PI;
}

function differenceAt(expected, index, code, gotBits, rightBits) {
    const inRow = expected.row_bytes / code.bytes;
    const [row, codeInRow] = [Math.floor(index / inRow), index % inRow];
    return {
        map: expected.name,
        row,
        column: Math.floor(codeInRow / expected.channels),
        channel: expected.channels > 1 ? "xyzw"[codeInRow % expected.channels] : null,
        got: readable(code, gotBits),
        expected: readable(code, rightBits),
    };
}

function largestOf(all) {
    const most = (of) => Math.max(0, ...all.map((one) => one?.[of] ?? 0));
    return { codes: most("codes"), ulps: most("ulps"), degrees: most("degrees") };
}

// The inputs that a differing value was made of, row by row; null beyond the border, where the edge mode decides.
function inputsAround(recording, { row, column }) {
    const inputs = bytesOf(recording.inputs);
    return recording.given.map(({ name, reach, first_row: firstRow, ...rows }) => {
        const code = CODES[rows.code];
        const bytes = rowsIn(inputs, rows);
        const width = rows.row_bytes / code.bytes / rows.channels;
        const texel = (y, x) => {
            if (y < 0 || y >= rows.rows || x < 0 || x >= width) {
                return null;
            }
            const first = (y * width + x) * rows.channels;
            return [...Array(rows.channels).keys()].map((at) => readable(code, bitsAt(bytes, first + at, code)));
        };
        const around = [...Array(2 * reach + 1).keys()].map((at) => at - reach);
        return { name, texels: around.map((dy) => around.map((dx) => texel(row - firstRow + dy, column + dx))) };
    });
}

// The bytes of some rows without their padding.
function rowsIn(buffer, { place, row_words: rowWords, rows, row_bytes: rowBytes }) {
    const bytes = new Uint8Array(rows * rowBytes);
    for (let row = 0; row < rows; row++) {
        const start = 4 * (place + row * rowWords);
        bytes.set(buffer.subarray(start, start + rowBytes), row * rowBytes);
    }
    return bytes;
}

// How codes are read, and what their differences are counted in: codes, or units in the last place of 1.
const CODES = {
    u8: { bytes: 1, value: unsigned, unit: "codes", perUnit: 1 },
    i8: { bytes: 1, value: signed(8), unit: "codes", perUnit: 1 },
    u16: { bytes: 2, value: unsigned, unit: "codes", perUnit: 1 },
    i16: { bytes: 2, value: signed(16), unit: "codes", perUnit: 1 },
    f16: { bytes: 2, value: halfFloat, unit: "ulps", perUnit: 2 ** 10 },
    f32: { bytes: 4, value: float, unit: "ulps", perUnit: 2 ** 23 },
    bits: { bytes: 4, value: unsigned, unit: null, perUnit: 1 },
};

function bitsAt(bytes, index, code) {
    let bits = 0;
    for (let byte = code.bytes - 1; byte >= 0; byte--) {
        bits = bits * 256 + bytes[index * code.bytes + byte];
    }
    return bits;
}

function unsigned(bits) {
    return bits;
}

function signed(width) {
    return (bits) => (bits < 2 ** (width - 1) ? bits : bits - 2 ** width);
}

function float(bits) {
    return new Float32Array(Uint32Array.of(bits).buffer)[0];
}

function halfFloat(bits) {
    const [sign, exponent, fraction] = [bits >> 15 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
    if (exponent === 31) {
        return fraction ? NaN : sign * Infinity;
    }
    return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * (fraction / 1024));
}

// A code for people and for the report: `212 (0xd4)`.
function readable(code, bits) {
    const value = code.value(bits);
    const number = code.unit === "ulps" ? (Object.is(value, -0) ? "-0" : String(Number(value.toPrecision(9)))) : value;
    const hexadecimal = `0x${bits.toString(16).padStart(2 * code.bytes, "0")}`;
    return code.unit === null ? hexadecimal : `${number} (${hexadecimal})`;
}

// ---------------------------------------------------------------------------------------------------------------------
// The report
// ---------------------------------------------------------------------------------------------------------------------

function reportOf(notes, gpu, results, milliseconds) {
    const count = (result) => results.filter((one) => one.result === result).length;
    const sum = (of) => results.reduce((total, one) => total + one[of], 0);
    const counts = {
        cases: results.length,
        agree: count("agrees"),
        differ: count("differs"),
        failed: count("failed"),
        values: sum("values"),
        differences: sum("differences"),
    };
    return {
        ...Object.fromEntries(notes),
        // An empty run proves nothing.
        passed: counts.agree === counts.cases && counts.values > 0,
        ...counts,
        browser: navigator.userAgent,
        adapter: gpu.adapter ? wordsForAdapter(gpu.info) : null,
        unusable: gpu.unusable ?? null,
        seconds: Math.round(milliseconds) / 1000,
        limits: gpu.device ? limitsOf(gpu.device) : {},
        compiled: gpu.compiled ?? [],
        results,
    };
}

// The last two lines of the console, for programs: one for people, and one of JSON without what would make it long.
function tellAutomation(report) {
    const failures = report.failed > 0 ? `, ${report.failed} failed` : "";
    console.log(`texbake verify: ${report.agree} cases agree, ${report.differ} differ${failures}`);
    const { results, compiled, limits, ...counts } = report;
    const wrong = (result) => results.filter((one) => one.result === result);
    const differing = wrong("differs").map(({ name, differences, largest }) => ({ name, differences, largest }));
    const failing = wrong("failed").map(({ name }) => ({ name }));
    const slowest = compiled.toSorted((a, b) => b.milliseconds - a.milliseconds).slice(0, 5);
    const reasons = [...new Set(results.map(({ message }) => message).filter(Boolean))].slice(0, 5);
    const brief = { ...counts, slowest, reasons, differing, failing };
    console.log(`texbake verify report: ${JSON.stringify(brief)}`);
}

function wordsForAdapter({ vendor, architecture, device, description }) {
    return [vendor, architecture, device, description].filter(Boolean).join(", ") || "not told by the browser";
}

function limitsOf({ limits }) {
    const names = [
        "maxStorageBufferBindingSize",
        "maxBufferSize",
        "maxUniformBufferBindingSize",
        "maxComputeWorkgroupsPerDimension",
        "maxComputeInvocationsPerWorkgroup",
        "maxComputeWorkgroupSizeX",
    ];
    return Object.fromEntries(names.map((name) => [name, limits[name]]));
}

// ---------------------------------------------------------------------------------------------------------------------
// What is shown
// ---------------------------------------------------------------------------------------------------------------------

function withKernelNames(kernels) {
    return (recording) => {
        recording.kernel = recording.passes.map(({ kernel }) => kernels[kernel].name).join(" + ");
        return recording;
    };
}

// A row for each mix of kernel, precision and formats; gives the row of each recording.
function showPlannedRows(cases) {
    const [table, bodies, rows, rowOf] = [element("cases"), new Map(), new Map(), new Map()];
    for (const recording of cases) {
        const { operation, kernel, precision, formats } = recording;
        if (!bodies.has(operation)) {
            const title = make("th", { colSpan: 8, scope: "rowgroup" }, operation);
            bodies.set(operation, table.appendChild(make("tbody", {}, make("tr", {}, title))));
        }
        const key = JSON.stringify([operation, kernel, precision, formats, tolerancesOf(recording)]);
        if (!rows.has(key)) {
            rows.set(key, new CaseRow(bodies.get(operation), recording));
        }
        rows.get(key).planned += 1;
        rowOf.set(recording, rows.get(key));
    }
    rows.forEach((row) => row.show());
    return rowOf;
}

// The results of all cases of one kernel, precision and formats.
class CaseRow {
    constructor(body, recording) {
        this.planned = 0;
        this.results = [];
        this.recording = recording;
        this.row = body.appendChild(make("tr"));
    }

    add(result) {
        this.results.push(result);
        this.show();
    }

    show() {
        const { recording, results, planned } = this;
        const sum = (of) => results.reduce((total, one) => total + one[of], 0);
        const [values, differences] = [sum("values"), sum("differences")];
        const result = this.result();
        const count = results.length < planned ? `${results.length} of ${planned}` : planned;
        const cells = [
            ["Kernel", recording.kernel],
            ["Precision", [recording.precision, tolerancesOf(recording)].filter(Boolean).join(", ")],
            ["Formats", recording.formats],
            ["Cases", count, "number"],
            ["Values", values.toLocaleString("en"), "number"],
            ["Differences", differences.toLocaleString("en"), "number"],
            ["Largest difference", wordsForLargest(largestOf(results.map((one) => one.largest)), values)],
            ["Result", result, "result"],
        ];
        this.row.dataset.result = result;
        this.row.replaceChildren(
            ...cells.map(([label, text, className = ""]) => {
                const cell = make("td", { className }, String(text));
                cell.dataset.label = label;
                return cell;
            }),
        );
    }

    result() {
        const worst = ["failed", "differs"].find((bad) => this.results.some(({ result }) => result === bad));
        return worst ?? (this.results.length < this.planned ? "waiting" : "agrees");
    }
}

// `within 1 code`; nothing of exact bits.
function tolerancesOf({ expected }) {
    const words = expected
        .filter(({ tolerance }) => tolerance)
        .flatMap(({ code, channels, tolerance }) => [
            wordsForError(CODES[code].unit, tolerance[CODES[code].unit]),
            ...(isDirection({ code, channels }) ? [wordsForError("degrees", tolerance.degrees)] : []),
        ]);
    return words.length > 0 ? `within ${[...new Set(words)].join(", ")}` : "";
}

function wordsForLargest(largest, values) {
    const words = Object.entries(largest).flatMap(([unit, error]) => (error > 0 ? [wordsForError(unit, error)] : []));
    return words.join(", ") || (values > 0 ? "none" : "");
}

function wordsForError(unit, error) {
    switch (unit) {
        case "codes":
            return counted(error, "code");
        case "ulps":
            return `${short(error)} ulp`;
        default:
            return `${short(error)}°`;
    }
}

function showDevice(notes, gpu) {
    const facts = [...notes, ["browser", navigator.userAgent]];
    if (gpu.adapter) {
        const { vendor, architecture, device, description, isFallbackAdapter } = gpu.info;
        facts.push(
            ["vendor", vendor || "not told by the browser"],
            ["architecture", architecture || "not told by the browser"],
            ["device", [device, description].filter(Boolean).join(", ") || "not told by the browser"],
            ["kind", isFallbackAdapter ? "software" : "as the browser chose"],
        );
        facts.push(["limits", wordsForLimits(gpu.device.limits)]);
    }
    element("device").replaceChildren(...listed(facts));
}

function wordsForLimits(limits) {
    const mebibytes = (bytes) => `${Math.floor(bytes / 2 ** 20).toLocaleString("en")} MiB`;
    return [
        `${mebibytes(limits.maxStorageBufferBindingSize)} in a binding`,
        `${mebibytes(limits.maxBufferSize)} in a buffer`,
        `${limits.maxComputeWorkgroupsPerDimension.toLocaleString("en")} workgroups in each dimension`,
        `${limits.maxComputeInvocationsPerWorkgroup.toLocaleString("en")} invocations in a workgroup`,
    ].join(", ");
}

function showKernels(kernels) {
    element("kernels").replaceChildren(
        ...kernels.map(({ name, text }) => {
            const details = make("details", {}, make("summary", {}, name));
            // Thousands of lines that nobody may look at are laid out when somebody does.
            details.addEventListener("toggle", () => details.append(make("pre", {}, text)), { once: true });
            return details;
        }),
    );
}

function showProgress(done, all, name) {
    element("headline").textContent = `Running case ${done + 1} of ${all}`;
    element("summary").textContent = name;
    element("progress").max = all;
    element("progress").value = done;
}

function showVerdict(report) {
    const { passed, cases, values, seconds } = report;
    const headline = headlineOf(report);
    const counts = `${counted(cases, "case")}, ${counted(values, "value")} compared in ${seconds.toFixed(1)} seconds.`;
    element("headline").textContent = headline;
    element("summary").textContent = report.unusable ?? (cases === 0 ? "An empty run proves nothing." : counts);
    element("verdict").dataset.state = passed ? "good" : "bad";
    element("progress").hidden = true;
    document.title = `${headline} · texbake verify`;
}

function headlineOf({ passed, unusable, cases, differ, failed }) {
    if (passed) {
        return "Every case agrees";
    }
    if (unusable) {
        return "Nothing was compared";
    }
    if (cases === 0) {
        return "This page holds no case";
    }
    if (differ === 0) {
        return `${failed} of ${cases} cases failed`;
    }
    return `${differ} of ${cases} cases differ${failed > 0 ? `, and ${failed} failed` : ""}`;
}

// What this page itself did wrong: never a success, and never silence.
function showBroken(error) {
    element("headline").textContent = "The page itself failed";
    element("summary").textContent = error.stack ?? messageOf(error);
    element("verdict").dataset.state = "bad";
    document.title = "The page itself failed · texbake verify";
    const report = { passed: false, unusable: `The page itself failed: ${messageOf(error)}` };
    console.log("texbake verify: 0 cases agree, 0 differ, the page itself failed");
    console.log(`texbake verify report: ${JSON.stringify(report)}`);
}

function showProblems(results, unusable) {
    const differing = results.filter(({ result }) => result === "differs");
    const failing = results.filter(({ result }) => result === "failed");
    if (unusable || differing.length + failing.length === 0) {
        return;
    }
    const messages = Map.groupBy(failing, ({ message }) => message);
    const cards = [...messages].map(([message, cases]) => failureCard(message, cases));
    cards.push(...differing.slice(0, SHOWN_PROBLEMS).map((result, place) => differenceCard(result, place < 3)));
    if (differing.length > SHOWN_PROBLEMS) {
        const more = differing.length - SHOWN_PROBLEMS;
        cards.push(make("p", {}, `${counted(more, "more case")} that differ: the report has all of them.`));
    }
    element("problems-title").textContent =
        differing.length === 0 ? "What failed" : failing.length === 0 ? "What differs" : "What failed and what differs";
    element("problems-list").replaceChildren(...cards);
    element("problems").hidden = false;
}

function failureCard(message, cases) {
    const names = make("ul", {}, ...cases.map(({ name }) => make("li", {}, name)));
    const affected = make("details", {}, make("summary", {}, counted(cases.length, "case")), names);
    return make("div", { className: "problem" }, make("h3", {}, message), affected);
}

function differenceCard({ name, values, differences, largest, first }, open) {
    const facts = [
        ["differing values", `${differences.toLocaleString("en")} of ${values.toLocaleString("en")}`],
        ["largest difference", wordsForLargest(largest, values)],
        ["first difference", [wordsForPlace(first), first.channel].filter(Boolean).join(", ")],
        ["got", make("code", {}, first.got)],
        ["expected", make("code", {}, first.expected)],
        ...first.from.map(({ name, texels }) => [name, texelsAround(texels)]),
    ];
    return make("details", { className: "problem", open }, make("summary", {}, name), make("dl", {}, ...listed(facts)));
}

function wordsForPlace({ map, column, row }) {
    switch (map) {
        case "tangents":
        case "signs":
            return `${map}, fan ${row}`;
        case "marks":
            return `the mark of row ${row}`;
        default:
            return `${map}, column ${column}, row ${row}`;
    }
}

function texelsAround(texels) {
    if (texels.length === 1) {
        return make("code", {}, texels[0][0]?.join(", ") ?? "beyond the map");
    }
    const middle = (texels.length - 1) / 2;
    const cell = (texel, y, x) =>
        make("td", { className: x === middle && y === middle ? "here" : "" }, texel?.join(", ") ?? "edge");
    const rows = texels.map((row, y) => make("tr", {}, ...row.map((texel, x) => cell(texel, y, x))));
    return make("table", { className: "around" }, make("tbody", {}, ...rows));
}

function offerReport(report) {
    const [button, area, copied] = [element("copy"), element("report"), element("copied")];
    const text = JSON.stringify(report, null, 2);
    button.disabled = false;
    button.addEventListener("click", async () => {
        try {
            await navigator.clipboard.writeText(text);
            copied.textContent = "Copied.";
        } catch {
            area.value = text;
            area.hidden = false;
            area.select();
            copied.textContent = "The browser does not let pages copy: here it is, selected.";
        }
    });
}

// ---------------------------------------------------------------------------------------------------------------------
// Small things
// ---------------------------------------------------------------------------------------------------------------------

function element(id) {
    return document.getElementById(id);
}

function make(tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
}

function listed(facts) {
    return facts.flatMap(([term, description]) => [make("dt", {}, term), make("dd", {}, description)]);
}

function counted(count, noun) {
    return `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;
}

// Three digits of any magnitude.
function short(number) {
    return number >= 0.01 && number < 1e5 ? String(Number(number.toPrecision(3))) : number.toExponential(1);
}

function bytesOf(base64) {
    return Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
}

function messageOf(error) {
    return error?.message || String(error);
}

function withPatience(promise) {
    let timer;
    const silence = new Promise((_, reject) => {
        const reason = `The device has not answered within ${PATIENCE_SECONDS} seconds.`;
        timer = setTimeout(() => reject(new Error(reason)), 1000 * PATIENCE_SECONDS);
    });
    return Promise.race([promise, silence]).finally(() => clearTimeout(timer));
}

// Lets the tab draw and answer if it has not for a while.
let turnBegan = performance.now();
async function nextTurn() {
    if (performance.now() - turnBegan > TURN_MILLISECONDS) {
        await new Promise((resolve) => setTimeout(resolve));
        turnBegan = performance.now();
    }
}
