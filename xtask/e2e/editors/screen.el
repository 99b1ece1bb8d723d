;;; Emacs in a terminal, with a list of the messages below the text.  -*- lexical-binding: t -*-
;;
;; Usage: emacs -nw -q -l screen.el FILE.

(load (expand-file-name "init" (file-name-directory load-file-name)) nil t)
(setq inhibit-startup-screen t
      native-comp-async-report-warnings-errors nil)
(load-theme 'wombat t)
(dolist (hook '(rt-mode-hook rt-ts-mode-hook))
  (add-hook hook #'eglot-ensure)
  (add-hook hook #'display-line-numbers-mode))

(defvar waits
  (run-with-timer 0.2 0.2 (lambda ()
                            (when (and (bound-and-true-p flymake-mode) (flymake-diagnostics))
                              (cancel-timer waits)
                              (flymake-show-buffer-diagnostics))))
  "Looks whether there are messages.")
