vim.filetype.add({ extension = { rt = 'rt' } })
