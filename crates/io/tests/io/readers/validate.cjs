// node validate.cjs VALIDATOR FILE.glb: fails if the validator finds anything.
const fs = require("fs");
const [validator, file] = process.argv.slice(2);
require(validator)
  .validateBytes(new Uint8Array(fs.readFileSync(file)))
  .then((report) => {
    const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
    console.log(JSON.stringify(messages, null, 1));
    if (numErrors + numWarnings + numInfos + numHints > 0 || report.info.animationCount !== 1) process.exit(1);
  });
