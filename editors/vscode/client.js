// Starts `mbs lsp` and connects the editor with it.
"use strict";

const { commands, window, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

async function start() {
  const command = workspace.getConfiguration("mbs").get("path", "mbs");
  const server = { command, args: ["lsp"] };
  client = new LanguageClient("mbs", "mbs", server, {
    documentSelector: [{ language: "mbs", scheme: "file" }, { language: "mbs", scheme: "untitled" }],
    // Tables and robots are imported, too: what is wrong in them is said where they are imported.
    synchronize: { fileEvents: workspace.createFileSystemWatcher("**/*.{mbs,csv,urdf,sdf,xml}") },
  });
  try {
    await client.start();
  } catch (error) {
    window.showErrorMessage(`mbs: \`${command} lsp\` does not start (${error.message}). Is it on the path, or in \`mbs.path\`?`);
  }
}

exports.activate = async (context) => {
  const restart = async () => {
    await exports.deactivate();
    await start();
  };
  context.subscriptions.push(commands.registerCommand("mbs.restart", restart));
  await start();
};

exports.deactivate = async () => {
  const running = client;
  client = undefined;
  if (running && running.needsStop()) await running.stop();
};
