// Somebody at the page of a preview, who sets a param and writes it. Prints what the page says, and fails where it is not written.
//
// Usage: node write.mjs RTC TOOLS URL PARAM VALUE

import { browse, open } from "../preview/setting.mjs";

const [, , url, name, value] = process.argv.slice(2);
const browser = await browse();
try {
  const page = await open(browser, url);
  const row = page.locator(".param", { has: page.locator(`#param-${name}`) });
  await row.getByRole("textbox").fill(value);
  await page.keyboard.press("Enter");
  await row.getByRole("button", { name: "Write" }).click();
  const toast = page.locator("#toast");
  await toast.waitFor();
  const said = await toast.textContent();
  console.log(said);
  if (!said.endsWith("is written")) process.exitCode = 1;
} finally {
  await browser.close();
}
