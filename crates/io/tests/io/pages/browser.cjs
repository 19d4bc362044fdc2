// node browser.cjs NODE_MODULES PAGE.html: opens the page in Chromium without a network, uses every
// control, takes screenshots beside the page, and fails on any word in the console, any request, and
// anything serious that axe finds.
const path = require("path");
const assert = require("assert");
const [modules, file] = process.argv.slice(2);
const { chromium } = require(path.join(modules, "playwright-core"));
const axe = require.resolve(path.join(modules, "axe-core/axe.min.js"));

async function useEveryControl(page) {
  const now = () => page.textContent("#now");
  const pressed = async (key) => {
    const before = await now();
    await page.keyboard.press(key);
    assert.notStrictEqual(await now(), before, key);
  };
  await page.click("h1");
  for (const key of ["ArrowRight", "End", "ArrowLeft", "PageUp", "PageDown", "Home"]) await pressed(key);
  for (const id of ["#next", "#previous", "#view-back", "#view-palm", "#view-thumb", "#nearer", "#farther", "#zoom-in", "#zoom-in", "#zoom-out", "#zoom-all"]) await page.click(id);
  await page.fill("#frame", "12");
  assert.match(await page.getAttribute("#frame", "aria-valuetext"), /^frame 1[23] /);
  await page.selectOption("#speed", "2");
  await page.click("#play");
  await page.waitForFunction(() => document.getElementById("frame").value !== "12");
  if ((await page.getAttribute("#play", "aria-pressed")) === "true") await page.click("#play");
  const frame = await page.inputValue("#frame");
  await page.click("#quality", { position: { x: 200, y: 30 } });
  assert.notStrictEqual(await page.inputValue("#frame"), frame, "a click on a curve goes there");
  for (const button of (await page.$$("#doubts button")).slice(0, 3)) {
    await button.click();
    assert.match(await now(), /doubted: /);
  }
  await page.selectOption("#group", "index");
  assert.strictEqual(await page.locator(".angle:visible").count(), 4);
  await page.selectOption("#group", "all");
  assert.strictEqual(await page.locator(".angle:visible").count(), 28);
  const canvas = page.locator("#hand-canvas");
  await page.fill("#frame", "20");
  const before = await canvas.screenshot();
  await canvas.focus();
  for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) await page.keyboard.press(key);
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + 50, box.y + 50);
  await page.mouse.down();
  await page.mouse.move(box.x + 120, box.y + 70);
  await page.mouse.up();
  assert.ok(!before.equals(await canvas.screenshot()), "the hand turns");
  await page.click("#view-thumb");
  for (const _ of [0, 1, 2]) await page.click("#theme");
  await page.fill("#frame", "20");
}

// Draws the page anew at a size and in colours, and takes pictures of it.
async function show(page, width, colorScheme) {
  await page.setViewportSize({ width, height: 900 });
  await page.emulateMedia({ colorScheme });
  await page.evaluate(() => {
    scrollTo(0, 0);
    dispatchEvent(new Event("beforeprint"));
  });
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(overflow <= 0, `the page is ${overflow} px too wide at ${width} px`);
  const picture = (end) => file.replace(".html", `-${width}-${colorScheme}${end}.png`);
  await page.screenshot({ path: picture("") });
  if (width === 1280 && colorScheme === "light") await page.screenshot({ path: picture("-whole"), fullPage: true });
}

// What a checker of accessibility finds serious.
async function inaccessible(page) {
  const { violations } = await page.evaluate(() => window.axe.run());
  const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  return serious.map(({ id, nodes }) => `axe: ${id} ${nodes[0].html} ${nodes[0].failureSummary}`);
}

(async () => {
  const browser = await chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
  const complaints = [];
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: "light", offline: true });
  // Programs draw here without a graphics card, and others may be at work.
  context.setDefaultTimeout(120_000);
  const page = await context.newPage();
  page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(`error: ${error}`));
  page.on("request", (request) => /^(file|data):/.test(request.url()) || complaints.push(`asks for ${request.url()}`));
  await page.goto(`file://${path.resolve(file)}`);
  await useEveryControl(page);
  await page.click("h1");
  await page.evaluate(require("fs").readFileSync(axe, "utf8"));
  for (const colorScheme of ["light", "dark"]) {
    for (const width of [400, 1280, 2560]) await show(page, width, colorScheme);
    complaints.push(...(await inaccessible(page)));
  }
  await page.setViewportSize({ width: 400, height: 900 });
  complaints.push(...(await inaccessible(page)));
  await browser.close();
  assert.deepStrictEqual(complaints, []);
})().catch((error) => {
  console.error(error);
  process.exit(1);
});
