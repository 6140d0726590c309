-- Requirements in Neovim 0.11 or newer: put this file into `plugin/` of the configuration, or
-- `dofile` it. `fretc lsp` must be on PATH.
vim.filetype.add({ extension = { fret = 'fretish' } })
vim.lsp.config('fretc', {
  cmd = { 'fretc', 'lsp' },
  filetypes = { 'fretish', 'toml' },
  root_markers = { 'fretc.toml', '.git' },
})
vim.lsp.enable('fretc')
