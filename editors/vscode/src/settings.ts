// The settings, and the choice of the log.

import { isAbsolute, relative } from "node:path";
import * as vscode from "vscode";

const LOGS = ["mcap", "bag", "db3", "ulg", "bin", "csv", "jsonl", "parquet"];

export function programPath(): string {
  return vscode.workspace.getConfiguration("fretc").get<string>("path")?.trim() || "fretc";
}

/** The chosen log, as fretc is given it in the workspace folder; undefined if none is chosen. */
export function chosenLog(scope: vscode.Uri): string | undefined {
  return vscode.workspace.getConfiguration("fretc", scope).get<string>("log")?.trim() || undefined;
}

/** Ask for a log, and keep the choice in the settings of the workspace; undefined if none is chosen. */
export async function chooseLog(scope?: vscode.Uri): Promise<string | undefined> {
  const where = scope ?? vscode.window.activeTextEditor?.document.uri ?? vscode.workspace.workspaceFolders?.[0]?.uri;
  const folder = where && vscode.workspace.getWorkspaceFolder(where)?.uri;
  const [file] =
    (await vscode.window.showOpenDialog({
      title: "The recorded run against which requirements are audited",
      openLabel: "Audit against this log",
      canSelectFolders: false,
      filters: { "Recorded runs": LOGS, "All files": ["*"] },
      ...(folder ? { defaultUri: folder } : {}),
    })) ?? [];
  if (!file) return undefined;
  const inside = folder && relative(folder.fsPath, file.fsPath);
  const log = inside && !inside.startsWith("..") && !isAbsolute(inside) ? inside.replaceAll("\\", "/") : file.fsPath;
  const target = folder ? vscode.ConfigurationTarget.WorkspaceFolder : vscode.ConfigurationTarget.Global;
  await vscode.workspace.getConfiguration("fretc", folder ?? null).update("log", log, target);
  return log;
}
