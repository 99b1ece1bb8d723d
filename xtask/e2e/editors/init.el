;;; Our mode and nothing else, with the built server, in the environment's RTC.  -*- lexical-binding: t -*-

(add-to-list 'load-path (expand-file-name "editors/emacs" (getenv "ROOT")))
(require 'rt-mode)
(require 'eglot)
(setq rt-program (getenv "RTC")
      eglot-autoshutdown nil
      eglot-confirm-server-initiated-edits nil
      backup-inhibited t
      create-lockfiles nil)
