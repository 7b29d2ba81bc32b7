import { defineConfig } from "vite";

/** Where the service has these files; the page itself is at its root, or below any path. */
const FILES = "static/";

export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 0, chunkSizeWarningLimit: 2000 },
  experimental: {
    renderBuiltUrl: (name, { hostType }) => (hostType === "html" ? FILES + name : { relative: true }),
  },
});
