// The page of an explanation: what `fretc explain --format json` prints, and its timing diagram.

interface Row {
  readonly first: number;
  readonly last: number;
  readonly values: Readonly<Record<string, boolean | number | string | null>>;
  readonly repeats: boolean;
}

interface Trace {
  readonly verdict: string;
  readonly rows: readonly Row[];
  readonly decided: number | null;
  readonly reason: string;
}

export interface Explanation {
  readonly id: string;
  readonly title: string;
  readonly sentence: string;
  readonly meaning: string;
  readonly ft_infinite: string;
  readonly ft_finite: string;
  readonly pt: string;
  readonly diagram: { readonly words: string } | null;
  readonly traces: readonly Trace[];
  readonly notes: readonly string[];
}

const STYLE = `
body { font-family: var(--vscode-font-family, system-ui, sans-serif); font-size: var(--vscode-font-size, 13px);
  color: var(--vscode-foreground); padding: 0 20px 24px; line-height: 1.45; }
h1 { font-size: 1.5em; font-weight: 600; } h2 { font-size: 1.1em; font-weight: 600; margin: 1.6em 0 .4em; }
blockquote, code { font-family: var(--vscode-editor-font-family, monospace); }
blockquote { margin: 0; padding: 8px 12px; border-left: 3px solid var(--vscode-textBlockQuote-border, #888);
  background: var(--vscode-textBlockQuote-background, transparent); overflow-wrap: anywhere; }
img { max-width: 100%; height: auto; background: #fff; border-radius: 4px; }
table { border-collapse: collapse; margin: .4em 0; } .wide { overflow-x: auto; }
th, td { padding: 3px 10px; border: 1px solid var(--vscode-panel-border, #8884); text-align: center; }
th[scope=row] { text-align: left; font-weight: 400; font-family: var(--vscode-editor-font-family, monospace); }
.on { background: var(--vscode-editor-selectionBackground, #2f5f9e55); }
.satisfied { color: var(--vscode-testing-iconPassed, #388a34); } .violated { color: var(--vscode-testing-iconFailed, #c72e0f); }
.decides { border: 2px solid var(--vscode-testing-iconFailed, #c72e0f); }
dt { margin-top: .5em; } dd { margin: 0; overflow-wrap: anywhere; }
`;

/**
 * The page; it has no script, and its policy allows none.
 * @param nonce random; the style sheet bears it.
 * @param svg the timing diagram, or nothing. It is a picture, so that no script of it can run.
 */
export function explanationPage(explanation: Explanation, svg: string, nonce: string): string {
  const { id, title, sentence, meaning, traces, notes } = explanation;
  const policy = `default-src 'none'; img-src data:; style-src 'nonce-${nonce}'`;
  const words = explanation.diagram?.words ?? "";
  const picture = svg && `<img alt="${escaped(words)}" src="data:image/svg+xml;base64,${Buffer.from(svg, "utf8").toString("base64")}">`;
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escaped(id)}</title>
<style nonce="${nonce}">${STYLE}</style>
</head>
<body>
<h1>${escaped(title ? `${title} (${id})` : id)}</h1>
<blockquote>${escaped(sentence)}</blockquote>
<p>${marked(meaning)}</p>
${notes.map((note) => `<p>${marked(note)}</p>`).join("\n")}
${picture && `<h2>In time</h2>\n${picture}`}
<h2>Short runs</h2>
${traces.map(trace).join("\n")}
<h2>Formulas</h2>
<dl>
<dt>Future time, infinite runs</dt><dd><code>${escaped(explanation.ft_infinite)}</code></dd>
<dt>Future time, finite runs</dt><dd><code>${escaped(explanation.ft_finite)}</code></dd>
<dt>Past time</dt><dd><code>${escaped(explanation.pt)}</code></dd>
</dl>
</body>
</html>`;
}

function trace({ verdict, rows, reason, decided }: Trace): string {
  const names = Object.keys(rows[0]?.values ?? {});
  const decides = (row: Row) => decided !== null && row.first <= decided && decided <= row.last;
  const heads = rows.map((row) => `<th scope="col"${decides(row) ? ' class="decides"' : ""}>${ticks(row)}</th>`);
  const lines = names.map((name) => {
    const cells = rows.map((row) => cell(row.values[name]));
    return `<tr><th scope="row">${escaped(name)}</th>${cells.join("")}</tr>`;
  });
  return `<h3 class="${verdict === "satisfied" ? "satisfied" : "violated"}">${escaped(verdict)}</h3>
<p>${marked(reason)}${decided === null ? "" : `; decided at tick ${decided}`}</p>
<div class="wide"><table><tr><th scope="row">tick</th>${heads.join("")}</tr>
${lines.join("\n")}</table></div>`;
}

function ticks({ first, last, repeats }: Row): string {
  return `${first === last ? first : `${first} to ${last}`}${repeats ? " …" : ""}`;
}

function cell(value: boolean | number | string | null | undefined): string {
  if (value === undefined || value === null) return "<td>?</td>";
  return value === true ? '<td class="on">true</td>' : `<td>${escaped(String(value))}</td>`;
}

/** Text in which `names` between back quotes are code. */
function marked(text: string): string {
  return escaped(text).replaceAll(/`([^`]+)`/g, "<code>$1</code>");
}

export function escaped(text: string): string {
  const entities: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };
  return text.replaceAll(/[&<>"']/g, (character) => entities[character]!);
}

/** Whether a page of `fretc play` has the policy that forbids other scripts, and all network. */
export function hasStrictPolicy(page: string): boolean {
  const meta = /<meta http-equiv="Content-Security-Policy" content="([^"]*)">/.exec(page.slice(0, 4096));
  return meta !== null && meta[1]!.startsWith("default-src 'none';") && !meta[1]!.includes("unsafe");
}
