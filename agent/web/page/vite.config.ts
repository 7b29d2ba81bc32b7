import { defineConfig } from "vite";

/** Where the service has these files; the page itself is at its root, or below any path. */
const FILES = "static/";

// A library that YASGUI bundles names `eval`, and never comes there: JSON is built in.
const rolldownOptions = { checks: { eval: false, bundlerTimings: false }, input: ["index.html", "docs.html"] };

export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 0, chunkSizeWarningLimit: 2000, rolldownOptions },
  experimental: {
    renderBuiltUrl: (name, { hostType }) => (hostType === "html" ? FILES + name : { relative: true }),
  },
});
