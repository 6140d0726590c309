-- What a person does in Neovim with the real server; prints one line of JSON.
local answers = {}

local function await(what, condition)
  if not vim.wait(120000, condition, 50) then
    error('nothing came: ' .. what)
  end
end

local function request(client, method, params)
  local response, reason = client:request_sync(method, params, 120000, 0)
  assert(response, reason)
  return response.result
end

local function codes()
  local found = {}
  for _, diagnostic in ipairs(vim.diagnostic.get(0)) do
    found[#found + 1] = diagnostic.code
  end
  table.sort(found)
  return found
end

local function step()
  vim.cmd.edit('requirements/r1.fret')
  answers.filetype = vim.bo.filetype
  await('client', function() return #vim.lsp.get_clients({ bufnr = 0 }) == 1 end)
  local client = vim.lsp.get_clients({ bufnr = 0 })[1]
  await('start', function() return client.initialized end)
  answers.root = client.config.root_dir
  await('F107', function() return vim.tbl_contains(codes(), 'F107') end)
  answers.before = codes()

  local everything = vim.lsp.util.make_given_range_params({ 1, 0 }, { 99, 0 }, 0, client.offset_encoding)
  everything.context = { diagnostics = {}, only = { 'source.fixAll' } }
  local action = request(client, 'textDocument/codeAction', everything)[1]
  vim.lsp.util.apply_workspace_edit(action.edit, client.offset_encoding)
  await('the fix', function() return not vim.tbl_contains(codes(), 'F107') end)
  answers.fixed = vim.api.nvim_buf_get_lines(0, 0, -1, false)

  vim.fn.search('whenever near')
  vim.cmd.normal('w')
  local place = vim.lsp.util.make_position_params(0, client.offset_encoding)
  answers.hover = request(client, 'textDocument/hover', place).contents.value
  place.newName = 'too_near'
  local edit = request(client, 'textDocument/rename', place)
  vim.lsp.util.apply_workspace_edit(edit, client.offset_encoding)
  answers.renamed = vim.api.nvim_buf_get_lines(0, 0, -1, false)
  vim.cmd.wall()
  vim.lsp.stop_client(client.id)
  await('end', function() return client:is_stopped() end)
end

local ok, reason = pcall(step)
if not ok then answers.error = tostring(reason) end
io.stdout:write(vim.json.encode(answers) .. '\n')
vim.cmd.quitall({ bang = true })
