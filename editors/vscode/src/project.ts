// The project of a requirement file, as the options of fretc name it.

import { dirname, relative } from "node:path";

export interface Project {
  /** The folder in which fretc runs: its outputs are in `build` below it. */
  readonly folder: string;
  /** The folder of the requirement files, relative to `folder`, with `/`. */
  readonly requirements: string;
}

/** The project of a file: the folder of the file, in the workspace folder around it. */
export function projectOf(file: string, workspaceFolder: string | undefined): Project {
  const folder = workspaceFolder ?? dirname(file);
  const requirements = relative(folder, dirname(file)).replaceAll("\\", "/");
  return { folder, requirements: requirements || "." };
}

export function explainArguments(project: Project, id: string, diagram: string): string[] {
  return ["explain", "--requirements", project.requirements, "--format", "json", "--svg", diagram, "--", id];
}

export function playArguments(project: Project): string[] {
  return ["play", "--requirements", project.requirements, "-o", "-"];
}

/** The evidence of `requirements/` is the default file; another project of the folder has its own. */
export function auditArguments(project: Project, log: string): string[] {
  const output = project.requirements === "requirements" ? [] : ["-o", `build/${evidenceName(project)}.json`];
  return ["audit", "--requirements", project.requirements, "--format", "json", ...output, "--", log];
}

function evidenceName(project: Project): string {
  return project.requirements === "." ? "evidence" : project.requirements.replace(/^requirements\//, "").replaceAll("/", "-");
}

/** The path of a file as fretc is given it. */
export function relativeTo(project: Project, file: string): string {
  return relative(project.folder, file).replaceAll("\\", "/") || ".";
}

export function verifyArguments(project: Project, file: string): string[] {
  return ["verify", "--monitor", "--", relativeTo(project, file)];
}

export function testArguments(project: Project, id: string, file: string): string[] {
  return ["test", "--show", id, "--", relativeTo(project, file)];
}

