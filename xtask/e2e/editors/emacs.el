;;; What a person does in Emacs, in batch: our mode by itself, and eglot with the built server.  -*- lexical-binding: t -*-
;;
;; Usage: emacs --batch -l emacs.el, in an empty folder, with RTC and ROOT in the environment.  An Emacs that has
;; tree-sitter compiles the grammar first, and takes the mode that colours by it.

(require 'cl-lib)
(load (expand-file-name "init" (file-name-directory load-file-name)) nil t)
(defvar root (getenv "ROOT"))
(setq eglot-sync-connect t)

(defconst scene "// A ball on a floor.
param size: length = 50cm in 10cm to 1m
material paint = diffuse { color: #d94f30 }
sphere ball { at: (0, size, 0), radius: size, material: paint }
plane {}
light { at: (2, 3, 2)m, power: 60W }
camera { from: (0, 1, 4)m, look: ball }
")

(defun tell (what) (princ (format "  emacs %d: %s\n" emacs-major-version what)))

(defun check (holds what)
  (unless holds (error "%s" what)))

(defun wait (what holds)
  (let ((end (+ (float-time) 20)) value)
    (while (not (or (setq value (funcall holds)) (> (float-time) end)))
      (accept-process-output nil 0.05))
    (check value (format "waited in vain until %s" what))))

(defun change (old new)
  "Replace OLD by NEW, as typing does, and tell the server."
  (goto-char (point-min))
  (search-forward old)
  (replace-match new t t)
  (eglot--signal-textDocument/didChange)
  (goto-char (match-beginning 0)))

(defun names (entry)
  "The names of what ENTRY of an index leads to."
  (if (consp (cdr entry)) (mapcar #'names (cdr entry)) (car entry)))

(defun face (place)
  (goto-char (point-min))
  (search-forward place)
  (get-text-property (match-beginning 0) 'face))

(defconst trees (and (fboundp 'treesit-available-p) (treesit-available-p)))
(defconst mode (if trees 'rt-ts-mode 'rt-mode))
(when trees
  (defvar treesit-language-source-alist)
  (setq treesit-language-source-alist `((rt ,root nil "editors/tree-sitter-rt/src")))
  (treesit-install-language-grammar 'rt)
  (tell "the grammar is compiled"))

(with-temp-file "scene.rt" (insert scene))
(find-file "scene.rt")
(check (eq major-mode mode) (format "the mode is %s" major-mode))
(font-lock-ensure)
(dolist (wanted `(("ball on" font-lock-comment-face)
                  ("param" font-lock-keyword-face)
                  ("length" font-lock-type-face)
                  ("diffuse" font-lock-type-face)
                  ("size" font-lock-variable-name-face)
                  ("color" ,(if trees 'font-lock-property-name-face 'font-lock-variable-name-face))
                  ("#d94f30" font-lock-constant-face)
                  ("50cm" font-lock-constant-face)))
  (check (eq (face (car wanted)) (cadr wanted)) (format "%s is %s" (car wanted) (face (car wanted)))))
(tell "words have their colours")

(check (eq (key-binding (kbd "C-c C-p")) 'rt-preview) "C-c C-p opens the preview")
(define-key (symbol-value (intern (format "%s-map" mode))) (kbd "C-c C-x") #'ignore)
(check (eq (key-binding (kbd "C-c C-x")) 'ignore) "keys can be added")
(tell "keys do what they should")

(dolist (file (directory-files-recursively (expand-file-name "examples" root) "\\.rt\\'"))
  (with-temp-buffer
    (insert-file-contents file)
    (let ((written (buffer-string)))
      (funcall mode)
      (goto-char (point-min))
      (while (not (eobp)) (delete-horizontal-space) (forward-line))
      (indent-region (point-min) (point-max))
      (check (equal (buffer-string) written) (format "%s is indented otherwise:\n%s" file (buffer-string))))))
(with-temp-buffer
  (let ((noted "sphere {\n  /* a\n     b */\n  radius: 1m // /* c\n}\nlet a = 4\n  / 2\n  * 3\n/*\n * d\n    */\nplane {\n}\n"))
    (insert noted)
    (funcall mode)
    (indent-region (point-min) (point-max))
    (check (equal (buffer-string) noted) (format "comments are indented otherwise:\n%s" (buffer-string)))))
(tell "what is laid out is indented so")

(require 'imenu)
(with-temp-buffer
  (insert "param size: length = 1m\n\npart stool {\n  param wood: number = 1\n  sphere leg {\n    radius: size\n  }\n}\n"
          "fn half(x: number) -> number = x / 2\nlet a = 1\nstool {}\n")
  (funcall mode)
  (let ((listed (imenu--make-index-alist t)))
    (dolist (wanted '(("Params" "size" "wood") ("Parts" "stool") ("Functions" "half") ("Values" "a") ("Things" "leg")))
      (let ((found (flatten-tree (mapcar #'names (cdr (assoc (car wanted) listed))))))
        (check (equal (seq-remove (lambda (name) (equal name " ")) found) (cdr wanted)) (format "%S" listed)))))
  (when trees
    (re-search-backward "radius")
    (check (equal (add-log-current-defun) "stool.leg") (format "%S" (add-log-current-defun)))
    (beginning-of-defun)
    (check (looking-at "[ \t]*sphere leg") (buffer-substring (point) (line-end-position)))))
(tell "what is declared is listed")

(apply #'eglot--connect (eglot--guess-contact))
(check (eglot-current-server) "the server starts")
(check (eglot-managed-p) "the buffer is managed")
(flymake-mode 1)

(defun messages ()
  (flymake-start)
  (flymake-diagnostics))

(change "radius: size" "radius: 8deg")
(wait "the slip is told" #'messages)
(check (string-match-p "E0203\\|length" (flymake-diagnostic-text (car (messages))))
       (flymake-diagnostic-text (car (messages))))
(change "8deg" "size")
(wait "the message goes" (lambda () (null (messages))))
(tell "messages appear and go")

(change "plane {}" "plane { no")
(goto-char (point-min))
(search-forward "{ no")
(let* ((found (eglot-completion-at-point))
       (all (all-completions "no" (nth 2 found))))
  (check (cl-some (lambda (it) (string-match-p "normal" it)) all) (format "%S" all)))
(change "plane { no" "plane {}")
(tell "completion knows fields, in a broken statement too")

(goto-char (point-min))
(search-forward "radius")
(let ((answer (jsonrpc-request (eglot-current-server) :textDocument/hover (eglot--TextDocumentPositionParams))))
  (check (string-match-p "length" (format "%S" (plist-get answer :contents))) (format "%S" answer)))
(tell "hover tells what is there")

(goto-char (point-min))
(search-forward "material pai")
(eglot-rename "clay")
(check (string-match-p "material clay = \\(.\\|\n\\)*material: clay }" (buffer-string)) (buffer-string))
(tell "renaming reaches every use")

(change "plane {}" "plane   {  }")
(eglot-format-buffer)
(check (string-match-p "^plane {}$" (buffer-string)) (buffer-string))
(tell "the text is laid out")

(let (page)
  (cl-letf (((symbol-function 'browse-url) (lambda (address &rest _) (setq page address))))
    (rt-preview)
    (wait "the page opens" (lambda () page)))
  (check (string-match-p "\\`http://127\\.0\\.0\\.1:[0-9]+/[[:alnum:]]+/\\'" page) page))
(tell "the live preview serves the text, saved or not")

(save-window-excursion
  (goto-char (point-min))
  (let ((place '(:start (:line 3 :character 7) :end (:line 3 :character 7))))
    (eglot-handle-request (eglot-current-server) 'window/showDocument
                          :uri (plist-get (eglot--TextDocumentIdentifier) :uri) :selection place))
  (check (looking-at "ball { at") (buffer-substring (point) (line-end-position))))
(save-window-excursion
  (with-temp-file "clicked.rt" (insert "// A floor.\n/* \N{GRINNING FACE} */ plane { }\n"))
  (find-file "clicked.rt")
  (search-forward "plane ")
  (let ((place (eglot--pos-to-lsp-position)))
    (goto-char (point-min))
    (eglot-handle-request (eglot-current-server) 'window/showDocument
                          :uri (plist-get (eglot--TextDocumentIdentifier) :uri)
                          :selection (list :start place :end place)))
  (check (looking-at "{ }") (buffer-substring (point) (line-end-position))))
(tell "a place that is clicked on in the preview is shown")

(save-buffer)
(eglot-shutdown (eglot-current-server))
(tell "the server ends when it is told to")

(with-temp-file "it's 100% wrong.rt" (insert "sphere { radius: 1m }\nsphere { radius: 8deg }\n"))
(find-file "it's 100% wrong.rt")
(require 'compile)
(dolist (command (list #'rt-build (lambda () (compile compile-command))))
  (goto-char (point-min))
  (save-window-excursion
    (funcall command)
    (wait "the program ends" (lambda () (not (get-buffer-process "*compilation*"))))
    (with-current-buffer "*compilation*" (check (string-match-p "E0203" (buffer-string)) (buffer-string)))
    (next-error 1 t)
    (check (and (string-suffix-p "wrong.rt" (buffer-name)) (looking-at "8deg"))
           (format "%S %S" (current-buffer) (buffer-substring (point) (line-end-position))))))
(tell "errors of a build can be gone to")
