-- Bramah for Neovim 0.7 and newer. See README.md for how to use it.

local M = {}

local options = {
  path = 'bramah', -- the program
  libraries = {}, -- folders with further packages
  open = nil, -- how :BramahNetwork shows a file; takes its path
}

-- Clients by their root folder, for Neovim before 0.8.
local clients = {}

-- The folder that a file belongs to: that of its Git repository, or that of its outermost package.
local function root(file)
  local folder = vim.fn.fnamemodify(file, ':p:h')
  local git = vim.fn.finddir('.git', vim.fn.escape(folder, ' ,;') .. ';')
  if git ~= '' then return vim.fn.fnamemodify(git, ':p:h:h') end
  while vim.fn.filereadable(vim.fn.fnamemodify(folder, ':h') .. '/package.mo') == 1 do
    folder = vim.fn.fnamemodify(folder, ':h')
  end
  return folder
end

-- The keys that Neovim 0.11 gives a language server, and `gd`.
local function keys(_, buffer)
  vim.bo[buffer].omnifunc = 'v:lua.vim.lsp.omnifunc'
  local function map(key, act) vim.keymap.set('n', key, act, { buffer = buffer }) end
  map('K', vim.lsp.buf.hover)
  map('gd', vim.lsp.buf.definition)
  map('grn', vim.lsp.buf.rename)
  map('grr', vim.lsp.buf.references)
  map('gra', vim.lsp.buf.code_action)
  map('gO', vim.lsp.buf.document_symbol)
  if vim.lsp.inlay_hint then vim.lsp.inlay_hint.enable(true, { bufnr = buffer }) end
end

local function start(buffer)
  local config = {
    name = 'bramah',
    cmd = { options.path, 'lsp' },
    root_dir = root(vim.api.nvim_buf_get_name(buffer)),
    init_options = { libraries = options.libraries },
    on_attach = keys,
  }
  if vim.lsp.start then
    vim.lsp.start(config, { bufnr = buffer })
    return
  end
  local id = clients[config.root_dir]
  if not id or vim.lsp.client_is_stopped(id) then
    id = vim.lsp.start_client(config)
    clients[config.root_dir] = id
  end
  if id then vim.lsp.buf_attach_client(buffer, id) end
end

local function show(file)
  if options.open then return options.open(file) end
  if vim.ui.open then return vim.ui.open(file) end
  vim.fn.jobstart({ vim.fn.has('mac') == 1 and 'open' or 'xdg-open', file }, { detach = true })
end

-- Writes the network of the file's model as SVG and shows it; `model` names one of several.
function M.network(model)
  local params = { uri = vim.uri_from_bufnr(0) }
  if model and model ~= '' then params.model = model end
  vim.lsp.buf_request(0, 'bramah/network', params, function(err, result)
    if err then return vim.notify('bramah: ' .. err.message, vim.log.levels.ERROR) end
    local folder = vim.fn.stdpath('cache') .. '/bramah'
    vim.fn.mkdir(folder, 'p')
    local file = folder .. '/' .. result.model .. '.svg'
    vim.fn.writefile(vim.split(result.svg, '\n'), file)
    show(file)
  end)
end

function M.setup(given)
  options = vim.tbl_extend('force', options, given or {})
  local group = vim.api.nvim_create_augroup('bramah', {})
  vim.api.nvim_create_autocmd({ 'BufRead', 'BufNewFile' }, {
    group = group,
    pattern = '*.mo',
    callback = function() vim.bo.filetype = 'modelica' end,
  })
  vim.api.nvim_create_autocmd('FileType', {
    group = group,
    pattern = 'modelica',
    callback = function(event)
      vim.bo.commentstring = '// %s'
      vim.bo.shiftwidth = 2
      vim.bo.expandtab = true
      if vim.api.nvim_buf_get_name(event.buf) ~= '' then start(event.buf) end
    end,
  })
  vim.api.nvim_create_user_command('BramahNetwork', function(command) M.network(command.args) end, { nargs = '?' })
end

return M
