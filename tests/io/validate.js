// What the Khronos glTF validator says about files: `node validate.js PACKAGE FILE...` prints a JSON list with, for
// each file, its messages as "severity code", in any order.
const fs = require('fs');
const path = require('path');

const [folder, ...files] = process.argv.slice(2);
const validator = require(path.resolve(folder));

async function messages(file) {
    const beside = (uri) => new Uint8Array(fs.readFileSync(path.resolve(path.dirname(file), decodeURIComponent(uri))));
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
        uri: path.basename(file),
        maxIssues: 0,
        externalResourceFunction: async (uri) => beside(uri),
    });
    if (report.issues.truncated) throw new Error(file + ': not all messages were given');
    return report.issues.messages.map((message) => `${message.severity} ${message.code}`);
}

Promise.all(files.map(messages))
    .then((all) => console.log(JSON.stringify(all)))
    .catch((error) => {
        console.error(error);
        process.exit(1);
    });
