// The preview as a person sees it: Debian's Chromium on the page of the built command. Pictures of the page stay in the
// folder of the step.

import { end } from "./check.mjs";

// One after the other: what is measured needs the machine.
for (const part of ["picture", "compare", "text", "window", "page"]) await import(`./${part}.mjs`);
await end();
