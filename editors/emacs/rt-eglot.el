;;; rt-eglot.el --- The language server of rtc for eglot  -*- lexical-binding: t -*-

;; SPDX-License-Identifier: MIT OR Apache-2.0

;;; Commentary:

;; `rt-mode' loads this where eglot is loaded.  It names the server,
;; and shows what the server asks for: the page of the live preview,
;; and the place of the text that was clicked on there.  Eglot does
;; so by itself only from Emacs 30 on.

;;; Code:

(require 'cl-lib)
(require 'eglot)

(defvar rt-program)

(declare-function eglot-uri-to-path "eglot")
(declare-function eglot--uri-to-path "eglot")

(defclass rt-eglot-server (eglot-lsp-server) ()
  :documentation "The language server of rtc.")

(add-to-list 'eglot-server-programs
             (cons '(rt-mode rt-ts-mode) (lambda (&rest _) (list 'rt-eglot-server rt-program "lsp"))))

(cl-defmethod eglot-client-capabilities ((_server rt-eglot-server))
  "Those of eglot, and that places are shown."
  (let ((known (cl-call-next-method)))
    (plist-put known :window (plist-put (copy-sequence (plist-get known :window)) :showDocument '(:support t)))))

(cl-defmethod eglot-handle-request
  ((_server rt-eglot-server) (_method (eql window/showDocument)) &key uri external selection &allow-other-keys)
  "Show the page or the file at URI: in the browser if EXTERNAL, else at SELECTION."
  (if (eq external t)
      (browse-url uri)
    (pop-to-buffer (find-file-noselect (funcall (if (fboundp 'eglot-uri-to-path) 'eglot-uri-to-path 'eglot--uri-to-path) uri)))
    (when-let ((start (plist-get selection :start)))
      (goto-char (eglot--lsp-position-to-point start))))
  '(:success t))

(provide 'rt-eglot)

;;; rt-eglot.el ends here
