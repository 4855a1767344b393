// Runs each recording on this browser's GPU and compares what comes back with what texbake's CPU reference answered.
// A recording (src/backend/gpu/recording.rs) is one computation as data: kernels, parameters, inputs, expected outputs.
"use strict";

// What stands in every byte of the outputs before a case: -6328 or -5.8 of floats, far from every answer.
const POISON = 0xc5;

// Room for the parameters of any kernel, as texbake has it.
const PARAMS_BYTES = 256;

// A case whose kernels are compiled and that has not answered for so long will not.
const PATIENCE_SECONDS = 120;

// Differing cases that are shown in full, and most rows that are unfolded unasked; the report has all of them.
const SHOWN_PROBLEMS = 30;

// Cases whose kernels are compiled while another one runs: browsers compile on several threads.
const CASES_AHEAD = 4;

// The tab stays usable if no turn of ours is longer.
const TURN_MILLISECONDS = 40;

addEventListener("load", () => verify().catch(showBroken));

async function verify() {
    const { notes, kernels, cases } = JSON.parse(element("recordings").textContent);
    const started = performance.now();
    const sabotaged = notes.some(([label]) => label === "sabotage");
    const results = [];
    cases.forEach((recording) => describe(recording, kernels));
    const lines = showPlannedLines(cases, sabotaged);
    showKernels(kernels, sabotaged);
    showSabotage(sabotaged);

    const gpu = await openGpu(kernels).catch((error) => ({ unusable: messageOf(error) }));
    showDevice(notes, gpu);
    for (const [number, recording] of cases.entries()) {
        showProgress(number, cases.length, recording.name);
        compileAhead(gpu, cases.slice(number + 1, number + 1 + CASES_AHEAD));
        const result = gpu.unusable ? notRun(recording) : await resultOf(gpu, recording);
        results.push(result);
        lines.get(recording.line).add(result);
        await nextTurn();
    }

    const blind = [...lines].filter(([, line]) => sabotaged && line.result() !== "differs");
    const unnoticed = blind.map(([name]) => name);
    const report = reportOf(notes, gpu, results, unnoticed, performance.now() - started);
    showVerdict(report, lines.size);
    showProblems(report);
    showCases(lines, report);
    offerReport(report);
    tellAutomation(report);
}

// What is said of a recording besides what it holds: its line in the summary, and the command that repeats it.
function describe(recording, kernels) {
    recording.kernel = recording.passes.map(({ kernel }) => kernels[kernel].name).join(" + ");
    recording.line = `${recording.operation}, ${recording.precision}`;
    // All of one operation and precision have the same one.
    recording.bound = recording.expected.find(({ tolerance }) => tolerance)?.tolerance ?? null;
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
async function outputsOf({ device, layout }, recording, pipelines) {
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
        // Slow compilers are no silence: patience begins when the kernels are compiled.
        const compiled = Promise.all(recording.passes.map((pass) => pipelineOf(gpu, pass)));
        const pipelines = await Promise.race([compiled, gpu.loss]);
        const outputs = await withPatience(Promise.race([outputsOf(gpu, recording, pipelines), gpu.loss]));
        if (gpu.stray) {
            throw new Error(`The device reports: ${gpu.stray}`);
        }
        return compared(recording, outputs);
    } catch (error) {
        return failed(recording, gpu.lost ?? messageOf(error));
    }
}

function failed(recording, message) {
    return { ...outlineOf(recording), result: "failed", ...NOTHING, message };
}

function notRun(recording) {
    return { ...outlineOf(recording), result: "not run", ...NOTHING };
}

// Of values: `differ` are those with other bits, `differences` those that are beyond the bound, which of `exact` are
// the same. Checks are marks by which each row proves that this run has written it.
const NOTHING = { values: 0, differ: 0, differences: 0, checks: 0, failed_checks: 0 };

function outlineOf({ name, operation, kernel, precision, formats }) {
    return { name, operation, kernel, precision, formats };
}

// Compares all maps of a recording; one that holds no value has proved nothing.
function compared(recording, outputs) {
    const maps = recording.expected.map((expected) => comparedMap(expected, outputs));
    if (maps.some(({ compared }) => compared === 0) || maps.length === 0) {
        return failed(recording, "Nothing was compared.");
    }
    const sum = (of) => maps.reduce((total, map) => total + (map[of] ?? 0), 0);
    const counts = Object.fromEntries(Object.keys(NOTHING).map((of) => [of, sum(of)]));
    const worst = maps.find((map) => map.first);
    return {
        ...outlineOf(recording),
        result: worst ? "differs" : "agrees",
        ...counts,
        errors: merged(maps.map(({ errors }) => errors)),
        first: worst && { ...worst.first, from: inputsAround(recording, worst.first) },
    };
}

// Compares the rows of one map with what is expected there.
function comparedMap(expected, outputs) {
    const { tolerance, channels, name } = expected;
    const code = CODES[expected.code];
    const [right, got] = [bytesOf(expected.bytes), rowsIn(outputs, expected)];
    const values = right.length / code.bytes;
    const errors = { codes: noError(), ulps: noError(), degrees: noError() };
    let [differ, beyond, first, turned] = [0, 0, null, 0];
    for (let index = 0; index < values; index++) {
        const [gotBits, rightBits] = [got, right].map((bytes) => bitsAt(bytes, index, code));
        if (isDirection(expected) && index % channels === 0) {
            turned = degreesBetween(...[got, right].map((bytes) => texelAt(bytes, index, code)));
            count(errors.degrees, turned);
        }
        const error = gotBits === rightBits ? 0 : Math.abs(code.value(gotBits) - code.value(rightBits)) * code.perUnit;
        if (code.unit !== null) {
            count(errors[code.unit], error);
        }
        if (gotBits === rightBits) {
            continue;
        }
        differ += 1;
        if (!(tolerance && error <= tolerance[code.unit] && turned <= tolerance.degrees)) {
            beyond += 1;
            first ??= differenceAt(expected, index, code, gotBits, rightBits);
        }
    }
    const counts =
        name === "marks" ? { checks: values, failed_checks: differ } : { values, differ, differences: beyond };
    return { compared: values, ...counts, errors, first };
}

function noError() {
    return { largest: 0, mean: 0, count: 0 };
}

// The mean is of all values, those without an error too.
function count(errors, error) {
    // A difference from NaN or infinity is larger than any.
    const size = Number.isFinite(error) ? error : Infinity;
    errors.count += 1;
    errors.mean = size === Infinity ? Infinity : errors.mean + (size - errors.mean) / errors.count;
    errors.largest = Math.max(errors.largest, size);
}

// The errors of many comparisons as those of one.
function merged(all) {
    const of = (unit) =>
        all.reduce((sum, errors) => {
            const [one, count] = [errors?.[unit] ?? noError(), sum.count + (errors?.[unit].count ?? 0)];
            const mean = count && (sum.mean * sum.count + one.mean * one.count) / count;
            return { largest: Math.max(sum.largest, one.largest), mean, count };
        }, noError());
    return { codes: of("codes"), ulps: of("ulps"), degrees: of("degrees") };
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

// The inputs that a differing value was made of, row by row, with the columns and rows where they lie. Beyond the
// border lies what the edge mode takes there; null where the recording does not have it.
function inputsAround(recording, { row, column }) {
    const inputs = bytesOf(recording.inputs);
    return recording.given.map(({ name, reach, first_row: firstRow, beside, ...rows }) => {
        const code = CODES[rows.code];
        const bytes = rowsIn(inputs, rows);
        const width = rows.row_bytes / code.bytes / rows.channels;
        const columnAt = (x) => (x < 0 ? beside?.[0] : x >= width ? beside?.[1] : x) ?? null;
        const texel = (y, x) => {
            if (y < 0 || y >= rows.rows || x === null || x >= width) {
                return null;
            }
            const first = (y * width + x) * rows.channels;
            return [...Array(rows.channels).keys()].map((at) => readable(code, bitsAt(bytes, first + at, code)));
        };
        const around = [...Array(2 * reach + 1).keys()].map((at) => at - reach);
        const columns = around.map((dx) => columnAt(column + dx));
        const texels = around.map((dy) => columns.map((x) => texel(row - firstRow + dy, x)));
        return { name, columns, rows: around.map((dy) => row + dy), texels };
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

function reportOf(notes, gpu, results, unnoticed, milliseconds) {
    const count = (result) => results.filter((one) => one.result === result).length;
    const sum = (of) => results.reduce((total, one) => total + one[of], 0);
    const counts = {
        cases: results.length,
        agree: count("agrees"),
        differ: count("differs"),
        failed: count("failed"),
        not_run: count("not run"),
        values: sum("values"),
        values_with_other_bits: sum("differ"),
        differences: sum("differences"),
        checks: sum("checks"),
        failed_checks: sum("failed_checks"),
    };
    return {
        ...Object.fromEntries(notes),
        // An empty run proves nothing.
        passed: counts.agree === counts.cases && counts.values > 0,
        ...counts,
        unnoticed,
        browser: navigator.userAgent,
        adapter: gpu.adapter ? wordsForAdapter(gpu.info) : null,
        unusable: gpu.unusable ?? null,
        seconds: Math.round(milliseconds) / 1000,
        limits: gpu.device ? limitsOf(gpu.device) : {},
        compiled: gpu.compiled ?? [],
        results: results.map((one) => (wentWrong(one) ? { ...one, command: commandOf(notes, one) } : one)),
    };
}

function wentWrong({ result }) {
    return result === "differs" || result === "failed";
}

// What repeats a case on the devices that a terminal reaches.
function commandOf(notes, { name }) {
    const { seed, sabotage } = Object.fromEntries(notes);
    const options = `--seed ${seed}${sabotage ? " --sabotage" : ""}`;
    return `texbake verify ${options} --only "${name.replace(/, dispatch \d+$/, "")}"`;
}

// The last two lines of the console, for programs: one for people, and one of JSON without what would make it long.
function tellAutomation(report) {
    const failures = report.failed > 0 ? `, ${report.failed} failed` : "";
    const missing = report.not_run > 0 ? `, ${report.not_run} not run` : "";
    console.log(`texbake verify: ${report.agree} cases agree, ${report.differ} differ${failures}${missing}`);
    const { results, compiled, limits, ...counts } = report;
    const wrong = (result) => results.filter((one) => one.result === result);
    const largest = (errors) => Object.fromEntries(Object.entries(errors).map(([unit, of]) => [unit, of.largest]));
    const differing = wrong("differs").map(({ name, differ, differences, errors }) => {
        return { name, values_with_other_bits: differ, differences, largest: largest(errors) };
    });
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

// A line for each operation in each precision, as the terminal has them; by name.
function showPlannedLines(cases, sabotaged) {
    const lines = new Map();
    for (const recording of cases) {
        if (!lines.has(recording.line)) {
            lines.set(recording.line, new Line(recording, sabotaged));
        }
        lines.get(recording.line).planned += 1;
    }
    lines.forEach((line) => line.show());
    return lines;
}

// All cases of one operation in one precision.
class Line {
    constructor(recording, sabotaged) {
        Object.assign(this, { recording, sabotaged, planned: 0, results: [] });
        this.row = element("lines").appendChild(make("tr"));
    }

    add(result) {
        this.results.push(result);
        this.show();
    }

    show() {
        const { recording, results, planned } = this;
        const { operation, precision, bound } = recording;
        const hasRun = results.some(({ values }) => values > 0);
        const sum = (of) => results.reduce((total, one) => total + one[of], 0);
        const total = (of) => (hasRun ? sum(of).toLocaleString("en") : "");
        const errors = merged(results.map((one) => one.errors));
        const count = results.length < planned ? `${results.length} of ${planned}` : planned;
        this.row.dataset.result = this.tone();
        this.row.replaceChildren(
            ...cells([
                ["Operation", operation],
                ["Precision", precision],
                ["Cases", count, "number"],
                ["Values", total("values"), "number"],
                ["Differ", total("differ"), "number"],
                ["Beyond the bound", total("differences"), "number"],
                ["Codes", wordsForErrors(errors.codes, bound?.codes), "errors"],
                ["ulp", wordsForErrors(errors.ulps, bound?.ulps), "errors"],
                ["Degrees", wordsForErrors(errors.degrees, bound?.degrees), "errors"],
                ["Result", this.words(), "result"],
            ]),
        );
    }

    count(result) {
        return this.results.filter((one) => one.result === result).length;
    }

    result() {
        const worst = ["failed", "differs", "not run"].find((bad) => this.count(bad) > 0);
        return worst ?? (this.results.length < this.planned ? "waiting" : "agrees");
    }

    // What a sabotaged kernel computes must differ.
    tone() {
        const result = this.result();
        return this.sabotaged ? ({ differs: "noticed", agrees: "failed" }[result] ?? result) : result;
    }

    words() {
        const result = this.result();
        switch (result) {
            case "agrees":
                return this.sabotaged ? "not noticed" : this.recording.bound ? "in bounds" : "same bits";
            case "differs":
                return `${this.sabotaged ? "noticed in" : "differs in"} ${this.count(result)}`;
            case "failed":
                return `failed in ${this.count(result)}`;
            default:
                return result;
        }
    }
}

// `largest 1`, `mean 0.01` and `bound 1`, one above the other; nothing of exact bits that agree.
function wordsForErrors({ largest, mean, count }, bound) {
    if (count === 0 || (bound === undefined && largest === 0)) {
        return "";
    }
    const words = [`largest ${short(largest)}`, `mean ${short(mean)}`];
    return (bound === undefined ? words : [...words, `bound ${exactly(bound)}`]).map((line) => make("div", {}, line));
}

// All cases, folded, those that went wrong first.
function showCases(lines, report) {
    const wrong = report.differ + report.failed;
    const rank = (result) => ["failed", "differs", "not run", "agrees"].indexOf(result);
    const folds = [...lines].map(([name, line]) => {
        const results = line.results.toSorted((a, b) => rank(a.result) - rank(b.result));
        const fold = make("details", {}, make("summary", {}, `${name}: ${wordsForCases(line)}`));
        // Rows that nobody may look at are laid out when somebody does.
        const fill = () => fold.append(casesTable(results, line.recording.bound));
        fold.addEventListener("toggle", fill, { once: true });
        fold.dataset.result = line.result();
        return fold;
    });
    folds.sort((a, b) => rank(a.dataset.result) - rank(b.dataset.result));
    const isWrong = ({ dataset }) => wentWrong(dataset);
    folds.filter(isWrong).forEach((fold) => (fold.open = wrong <= SHOWN_PROBLEMS));
    element("cases").replaceChildren(...(report.unusable ? [foldOf(report.cases, folds)] : folds));

    const only = element("only-wrong");
    const filter = () => (element("cases").dataset.only = only.checked ? "wrong" : "all");
    only.checked = wrong > 0;
    only.addEventListener("change", filter);
    element("filter").hidden = wrong === 0;
    filter();
}

// What has not run is a list that nobody needs.
function foldOf(cases, folds) {
    return make("details", {}, make("summary", {}, `${counted(cases, "case")} not run`), ...folds);
}

function wordsForCases(line) {
    const counts = ["differs", "failed", "not run", "agrees"].map((result) => [line.count(result), result]);
    const words = { differs: ["differs", "differ"], agrees: ["agrees", "agree"] };
    const said = counts.filter(([count]) => count > 0);
    return said.map(([count, result]) => `${count} ${words[result]?.[count === 1 ? 0 : 1] ?? result}`).join(", ");
}

function casesTable(results, bound) {
    const heads = ["Case", "Kernel", "Values", "Differ", "Beyond the bound", "Errors", "Result"];
    const classes = ["", "", "number", "number", "number", "", "result"];
    const head = heads.map((words, place) => make("th", { scope: "col", className: classes[place] }, words));
    const rows = results.map((one) => {
        const row = make("tr");
        row.dataset.result = one.result;
        const counts = one.values > 0 ? [one.values, one.differ, one.differences] : ["", "", ""];
        const numbers = counts.map((number) => number.toLocaleString("en"));
        const texts = [one.name, one.kernel, ...numbers, wordsForAll(one.errors, bound), one.result];
        row.append(...cells(texts.map((text, place) => [heads[place], text, classes[place]])));
        return row;
    });
    return make("table", {}, make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...rows));
}

// `largest 1 code, mean 0.01`, of each unit that has an error.
function wordsForAll(errors, bound) {
    const units = Object.entries(errors ?? {}).filter(([, { largest }]) => largest > 0);
    const said = units.map(([unit, { largest, mean }]) => {
        const most = bound ? `, bound ${exactly(bound[unit])}` : "";
        return `largest ${wordsForError(unit, largest)}, mean ${short(mean)}${most}`;
    });
    return said.join("; ");
}

// Cells that name themselves where there is no room for columns.
function cells(all) {
    return all.map(([label, content, className = ""]) => {
        const cell = make("td", { className }, ...[content].flat().map((it) => (it instanceof Node ? it : String(it))));
        cell.dataset.label = label;
        return cell;
    });
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

function showKernels(kernels, sabotaged) {
    element("kernels-are").textContent = sabotaged
        ? "The WGSL that was compiled: texbake's, with a constant of each kernel changed on purpose."
        : "The WGSL that was compiled, as it stands in texbake.";
    element("kernels-count").textContent = counted(kernels.length, "kernel");
    element("kernels").replaceChildren(
        ...kernels.map(({ name, text }) => {
            const details = make("details", {}, make("summary", {}, name));
            // Thousands of lines that nobody may look at are laid out when somebody does.
            details.addEventListener("toggle", () => details.append(make("pre", {}, text)), { once: true });
            return details;
        }),
    );
}

// So that nobody takes the differences for the device's.
function showSabotage(sabotaged) {
    element("sabotaged").hidden = !sabotaged;
    document.body.toggleAttribute("data-sabotaged", sabotaged);
    document.title = `${sabotaged ? `${SABOTAGED} · ` : ""}texbake verify`;
}

const SABOTAGED = "sabotaged on purpose: must differ";

function showProgress(done, all, name) {
    element("headline").textContent = `Running case ${done + 1} of ${all}`;
    element("summary").textContent = name;
    element("progress").max = all;
    element("progress").value = done;
}

function showVerdict(report, lines) {
    const { passed, cases, unusable, sabotage } = report;
    const headline = headlineOf(report);
    element("headline").textContent = headline;
    element("summary").textContent = unusable ?? (cases === 0 ? "An empty run proves nothing." : wordsForCounts(report));
    element("noticed").textContent = sabotage && !unusable ? wordsForSabotage(report, lines) : "";
    const isSabotageNoticed = sabotage && !unusable && report.unnoticed.length === 0 && cases > 0;
    element("verdict").dataset.state = isSabotageNoticed ? "sabotaged" : passed && !sabotage ? "good" : "bad";
    element("progress").hidden = true;
    document.title = `${sabotage ? `${SABOTAGED} · ` : ""}${headline} · texbake verify`;
}

function wordsForCounts({ cases, values, checks, failed_checks: failedChecks, seconds }) {
    const marks = failedChecks > 0 ? `${failedChecks.toLocaleString("en")} of ${counted(checks, "mark")} wrong` : null;
    return (
        `${counted(cases, "case")}, ${counted(values, "value")} compared in ${seconds.toFixed(1)} seconds; besides, ` +
        `${marks ?? counted(checks, "mark")} by which rows prove that they were written.`
    );
}

function wordsForSabotage({ unnoticed }, lines) {
    return unnoticed.length === 0
        ? `All ${counted(lines, "line")} of the summary noticed it, as they must; not every case can.`
        : `Not noticed in: ${unnoticed.join("; ")}.`;
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

function showProblems({ results, sabotage }) {
    const differing = results.filter(({ result }) => result === "differs");
    const failing = results.filter(({ result }) => result === "failed");
    if (differing.length + failing.length === 0) {
        return;
    }
    const messages = Map.groupBy(failing, ({ message }) => message);
    const cards = [...messages].map(([message, cases]) => failureCard(message, cases));
    cards.push(...differing.slice(0, SHOWN_PROBLEMS).map((result, place) => differenceCard(result, place < 3)));
    if (differing.length > SHOWN_PROBLEMS) {
        const more = differing.length - SHOWN_PROBLEMS;
        cards.push(make("p", {}, `${counted(more, "more case")} that differ: the report has all of them.`));
    }
    const title =
        differing.length === 0 ? "What failed" : failing.length === 0 ? "What differs" : "What failed and what differs";
    element("problems-title").textContent = title + (sabotage ? ", as it must" : "");
    element("problems-list").replaceChildren(...cards);
    element("problems").hidden = false;
}

function failureCard(message, cases) {
    const names = make("ul", {}, ...cases.map(({ name }) => make("li", {}, name)));
    const affected = make("details", {}, make("summary", {}, counted(cases.length, "case")), names);
    return make("div", { className: "problem" }, make("h3", {}, message), affected);
}

function differenceCard({ name, values, differ, differences, checks, failed_checks, errors, first, command }, open) {
    const of = (part, all) => `${part.toLocaleString("en")} of ${all.toLocaleString("en")}`;
    const facts = [
        ["values that differ", of(differ, values)],
        ["beyond the bound", of(differences, values)],
        ...(failed_checks > 0 ? [["wrong marks of rows", of(failed_checks, checks)]] : []),
        ["errors", wordsForAll(errors) || "none"],
        ["first beyond the bound", [wordsForPlace(first), first.channel].filter(Boolean).join(", ")],
        ["got", make("code", {}, first.got)],
        ["expected", make("code", {}, first.expected)],
        ...first.from.map((input) => [input.name, texelsAround(input)]),
        ["on a terminal", make("code", {}, command)],
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

function texelsAround({ columns, rows, texels }) {
    if (texels.length === 1) {
        return make("code", {}, texels[0][0]?.join(", ") ?? "beyond the map");
    }
    const middle = (texels.length - 1) / 2;
    const head = columns.map((column) => make("th", { scope: "col" }, column === null ? "beyond" : `column ${column}`));
    const cell = (texel, y, x) =>
        make("td", { className: x === middle && y === middle ? "here" : "" }, texel?.join(", ") ?? "beyond the edge");
    const body = texels.map((row, y) => {
        const title = make("th", { scope: "row" }, rows[y] < 0 ? "above row 0" : `row ${rows[y]}`);
        return make("tr", {}, title, ...row.map((texel, x) => cell(texel, y, x)));
    });
    const table = make("table", { className: "around" });
    table.append(make("thead", {}, make("tr", {}, make("td"), ...head)), make("tbody", {}, ...body));
    return make("div", { className: "scrolls" }, table);
}

function offerReport(report) {
    const [button, save, area, copied] = ["copy", "save", "report", "copied"].map(element);
    const text = JSON.stringify(report, null, 2);
    button.disabled = save.disabled = false;
    save.addEventListener("click", () => saveAs("texbake-verify.json", text));
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

// Through the browser's own downloads.
function saveAs(name, text) {
    const link = make("a", { download: name });
    const place = URL.createObjectURL(new Blob([text], { type: "application/json" }));
    link.href = place;
    link.click();
    setTimeout(() => URL.revokeObjectURL(place), 60_000);
}

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
    if (!Number.isFinite(number) || (Number.isInteger(number) && number < 1e5)) {
        return String(number);
    }
    return number >= 0.01 && number < 1e5 ? String(Number(number.toPrecision(3))) : number.toExponential(1);
}

// A bound is never shown wider or narrower than it is.
function exactly(number) {
    return Number(short(number)) === number ? short(number) : String(number);
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
