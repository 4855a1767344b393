// What ktx-parse reads in KTX2 files: `node read_ktx2.mjs PACKAGE FILE...` prints a JSON list with, for each file, its
// header, its descriptor, its keys and values, and its levels in base64.
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [folder, ...files] = process.argv.slice(2);
const { read } = await import(pathToFileURL(resolve(folder, 'dist/index.mjs')));

function found(file) {
    const container = read(new Uint8Array(readFileSync(file)));
    const [descriptor] = container.dataFormatDescriptor;
    return {
        header: [
            container.vkFormat, container.typeSize, container.pixelWidth, container.pixelHeight, container.pixelDepth,
            container.layerCount, container.faceCount, container.levelCount, container.supercompressionScheme,
        ],
        model: descriptor.colorModel,
        primaries: descriptor.colorPrimaries,
        transfer: descriptor.transferFunction,
        flags: descriptor.flags,
        samples: descriptor.samples.length,
        orientation: container.keyValue.KTXorientation,
        writer: container.keyValue.KTXwriter,
        levels: container.levels.map((level) => Buffer.from(level.levelData).toString('base64')),
    };
}

console.log(JSON.stringify(files.map(found)));
