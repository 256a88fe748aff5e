-- The checks of test.sh, run inside Neovim in a folder with Press.mo.

local here = vim.o.runtimepath:match('^[^,]+')
local shown
dofile(here .. '/bramah.lua').setup({
  path = vim.env.BRAMAH,
  open = function(file) shown = file end,
})

local clients = vim.lsp.get_clients or vim.lsp.get_active_clients
local failed = false
local function check(name, right, got)
  failed = failed or not right
  io.stdout:write((right and 'ok    ' or 'FAIL  ') .. name .. (right and '' or ': ' .. vim.inspect(got)) .. '\n')
end

local function wait(condition) return vim.wait(20000, condition, 20) end

vim.cmd('edit Press.mo')
local buffer = vim.api.nvim_get_current_buf()
local function text() return table.concat(vim.api.nvim_buf_get_lines(buffer, 0, -1, true), '\n') end

-- Puts the cursor on the first place where `word` begins after the text `before`.
local function at(before, word)
  vim.fn.cursor(1, 1)
  vim.fn.search('\\V' .. before .. '\\zs' .. word, 'c')
end

local function ask(method, params)
  local answers, err = vim.lsp.buf_request_sync(buffer, method, params, 20000)
  if not answers then return { error = err } end
  local _, answer = next(answers)
  return answer or {}
end

local function place() return vim.lsp.util.make_position_params(0, 'utf-16') end

local function messages()
  return vim.tbl_map(function(d) return d.message end, vim.diagnostic.get(buffer))
end

local function any(list, wanted)
  for _, text in ipairs(list) do
    if text:find(wanted, 1, true) then return true end
  end
  return false
end

check('file type', vim.bo.filetype == 'modelica', vim.bo.filetype)
local attached = wait(function() return #clients() > 0 and clients()[1].initialized end)
check('client', attached)
if not attached then vim.cmd('cquit 1') end

wait(function() return #messages() > 0 end)
check('message of an unknown class', any(messages(), 'RelifValve'), messages())

at('Hydraulic.', 'RelifValve')
local range = vim.lsp.util.make_range_params(0, 'utf-16')
range.context = { diagnostics = {} }
local actions = ask('textDocument/codeAction', range).result
local action = actions and actions[1]
check('correction is offered', action and action.title:find('ReliefValve', 1, true), actions)
if action then vim.lsp.util.apply_workspace_edit(action.edit, 'utf-16') end
check('correction is made', text():find('Hydraulic.ReliefValve relief', 1, true), text())
wait(function() return #messages() == 0 end)
check('no message after it', #messages() == 0, messages())

at('connect(relief.', 'port_b')
local hover = ask('textDocument/hover', place()).result
check('hover of a port', hover and vim.inspect(hover.contents):find('port_b', 1, true), hover)

at('connect(', 'pump')
local own = ask('textDocument/definition', place()).result
check('definition in the file', own and own.range.start.line == 3, own)

at('Hydraulic.', 'Volume')
local shipped = ask('textDocument/definition', place()).result
local file = shipped and vim.uri_to_fname(shipped.uri)
check('definition of a shipped class', file and vim.fn.filereadable(file) == 1 and file:find('Volume.mo', 1, true), shipped)

vim.api.nvim_buf_set_lines(buffer, 5, 5, true, { '  Hydraulic.' })
local items = ask('textDocument/completion', {
  textDocument = place().textDocument,
  position = { line = 5, character = #'  Hydraulic.' },
}).result
local labels = vim.tbl_map(function(item) return item.label end, items and (items.items or items) or {})
check('completion of classes', vim.tbl_contains(labels, 'Cylinder'), labels)
vim.api.nvim_buf_set_lines(buffer, 5, 6, true, {})

local help = ask('textDocument/signatureHelp', {
  textDocument = place().textDocument,
  position = { line = 3, character = #'     Hydraulic.FlowSource pump(' },
}).result
check('signature help', help and #help.signatures > 0, help)

if vim.lsp.buf.format then
  vim.lsp.buf.format({ timeout_ms = 20000 })
else
  vim.lsp.buf.formatting_sync(nil, 20000)
end
check('formatting', text():find('\n  Hydraulic.FlowSource pump(q = 1e-4);\n', 1, true), text())

at('Hydraulic.FlowSource ', 'pump')
local references = ask('textDocument/references', vim.tbl_extend('force', place(), { context = { includeDeclaration = true } })).result
check('references', references and #references == 2, references)

vim.lsp.buf.rename('supply')
wait(function() return text():find('connect(supply.port', 1, true) ~= nil end)
check('rename', text():find('FlowSource supply(', 1, true) and not text():find('pump.', 1, true), text())

local outline = ask('textDocument/documentSymbol', { textDocument = place().textDocument }).result
check('outline', outline and outline[1] and outline[1].name == 'Press', outline)

vim.cmd('BramahNetwork')
wait(function() return shown ~= nil end)
local svg = shown and table.concat(vim.fn.readfile(shown), '\n') or ''
check('network', svg:find('<svg', 1, true) and svg:find('supply', 1, true), svg:sub(1, 200))

at('', 'connect(relief')
vim.api.nvim_del_current_line()
wait(function() return any(messages(), 'relief.port_b') end)
check('message of an open port', any(messages(), 'relief.port_b'), messages())

local client = clients()[1]
vim.lsp.stop_client(clients())
check('server ends', wait(function() return not client or client.is_stopped() end))

vim.cmd(failed and 'cquit 1' or 'qall!')
