import { defineConfig } from "vite";

/** Where the service has these files; the page itself is at its root, or below any path. */
const FILES = "static/";

export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    assetsInlineLimit: 0, // the policy of the service allows no fonts but files
    chunkSizeWarningLimit: 2000,
    license: { fileName: "licences.md" },
    rolldownOptions: {
      input: ["index.html", "docs.html"],
      // A library that YASGUI bundles names `eval`, and never comes there: JSON is built in.
      checks: { eval: false, bundlerTimings: false },
    },
  },
  experimental: {
    renderBuiltUrl: (name, { hostType }) => (hostType === "html" ? FILES + name : { relative: true }),
  },
});
