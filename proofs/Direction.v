(** * How a direction turns

    d = v / |v| of a vector v that moves, and bounds on |d'| and |d''|, as the
    proof of the paper's Lemma 1 uses them twice: for rho = u / |u|, and for
    upsilon, the desired body x axis. [turn] in controller-core/src/
    attitude_reference.rs. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space.
Open Scope R_scope.

Definition direction (v : space) : space := scaled (/ length v) v.
(** The part of w orthogonal to v. *)
Definition across (v w : space) : space := sub w (scaled (dot (direction v) w) (direction v)).
(** d' and d'' for v' = v_1, v'' = v_2. *)
Definition direction_rate (v v_1 : space) : space := scaled (/ length v) (across v v_1).
Definition direction_second (v v_1 v_2 : space) : space :=
  sub (sub (scaled (/ length v) (across v v_2))
           (scaled (2 * dot (direction v) v_1 / length v) (direction_rate v v_1)))
      (scaled (square (direction_rate v v_1)) (direction v)).

Section Pointwise.

Variable v : space.
Hypothesis not_zero : 0 < length v.

Lemma direction_unit : square (direction v) = 1.
Proof.
  replace (square (direction v)) with (/ length v * / length v * square v) by (unfold direction; components; ring).
  rewrite <- length_squared. field. lra.
Qed.

Lemma direction_length : length (direction v) = 1.
Proof. unfold length. rewrite direction_unit. apply sqrt_1. Qed.

Lemma across_orthogonal : forall w, dot (direction v) (across v w) = 0.
Proof.
  intros w. unfold across.
  replace (dot (direction v) (sub w (scaled (dot (direction v) w) (direction v))))
    with (dot (direction v) w * (1 - square (direction v))) by (components; ring).
  rewrite direction_unit. ring.
Qed.

Lemma across_square : forall w,
  square (across v w) = square w - dot (direction v) w * dot (direction v) w.
Proof.
  intros w. unfold across. pose proof direction_unit as Hd. generalize dependent (direction v). intros d Hd.
  replace (square (sub w (scaled (dot d w) d)))
    with (square w - 2 * (dot d w * dot d w) + dot d w * dot d w * square d) by (components; ring).
  rewrite Hd. ring.
Qed.

Lemma across_shorter : forall w, length (across v w) <= length w.
Proof.
  intros w. apply length_below; [apply length_nonneg|].
  rewrite across_square, length_squared. pose proof (squared (dot (direction v) w)). lra.
Qed.

Lemma rate_orthogonal : forall w, dot (direction v) (direction_rate v w) = 0.
Proof.
  intros w. unfold direction_rate.
  replace (dot (direction v) (scaled (/ length v) (across v w)))
    with (/ length v * dot (direction v) (across v w)) by (components; ring).
  rewrite across_orthogonal. ring.
Qed.

Lemma rate_along_motion : forall w, dot (direction_rate v w) w = length v * square (direction_rate v w).
Proof.
  intros w. pose proof (rate_orthogonal w) as H.
  assert (Hw : w = add (scaled (length v) (direction_rate v w)) (scaled (dot (direction v) w) (direction v))).
  { unfold direction_rate, across. apply same; components; field; lra. }
  rewrite Hw at 2. generalize dependent (direction_rate v w). intros r H _.
  replace (dot r (add (scaled (length v) r) (scaled (dot (direction v) w) (direction v))))
    with (length v * square r + dot (direction v) w * dot (direction v) r) by (components; ring).
  rewrite H. ring.
Qed.

(** |d'| <= |v'| / |v| and |d''| <= |v''| / |v| + 3 (|v'| / |v|)^2, for bounds. *)
Theorem direction_turns_within : forall v_1 v_2 least most_1 most_2, 0 < least -> least <= length v ->
  length v_1 <= most_1 -> length v_2 <= most_2 ->
  length (direction_rate v v_1) <= most_1 / least /\
  length (direction_second v v_1 v_2) <= most_2 / least + 3 * ((most_1 / least) * (most_1 / least)).
Proof.
  intros v_1 v_2 l a b Hl Hv Ha Hb.
  assert (Hinv : 0 < / length v <= / l).
  { split; [now apply Rinv_0_lt_compat | now apply Rinv_le_contravar]. }
  assert (Hover : forall w c, length w <= c -> length (scaled (/ length v) (across v w)) <= c / l).
  { intros w c Hw. rewrite length_scaled, Rabs_pos_eq by lra. unfold Rdiv. rewrite Rmult_comm.
    pose proof (across_shorter w). apply Rmult_le_compat; try apply length_nonneg; lra. }
  pose proof (Hover v_1 a Ha) as Hrate. fold (direction_rate v v_1) in Hrate. split; [exact Hrate|].
  unfold direction_second.
  assert (Ha0 : 0 <= a) by (eapply Rle_trans; [apply length_nonneg | exact Ha]).
  assert (Hal : 0 <= a / l) by (eapply Rle_trans; [apply length_nonneg | exact Hrate]).
  assert (Halong : Rabs (2 * dot (direction v) v_1 / length v) <= 2 * (a / l)).
  { unfold Rdiv. rewrite 2!Rabs_mult, (Rabs_pos_eq 2), (Rabs_pos_eq (/ length v)) by lra.
    pose proof (cauchy_schwarz (direction v) v_1) as Hcs. rewrite direction_length in Hcs.
    rewrite Rmult_assoc. apply Rmult_le_compat_l; [lra|].
    apply Rmult_le_compat; try apply Rabs_pos; lra. }
  eapply Rle_trans; [apply triangle_sub|].
  assert (H1 : length (scaled (square (direction_rate v v_1)) (direction v)) <= (a / l) * (a / l)).
  { rewrite length_scaled, direction_length, Rabs_pos_eq, Rmult_1_r by apply square_nonneg.
    now apply square_below. }
  assert (H2 : length (scaled (2 * dot (direction v) v_1 / length v) (direction_rate v v_1)) <= 2 * (a / l) * (a / l)).
  { rewrite length_scaled. apply Rmult_le_compat; try apply Rabs_pos; try apply length_nonneg; assumption. }
  pose proof (triangle_sub (scaled (/ length v) (across v v_2))
    (scaled (2 * dot (direction v) v_1 / length v) (direction_rate v v_1))).
  pose proof (Hover v_2 b Hb). lra.
Qed.

End Pointwise.

(** ** These are the derivatives *)

Lemma length_moves : forall v t d, 0 < length (v t) -> moves v t d ->
  is_derive (fun s => length (v s)) t (dot (direction (v t)) d).
Proof.
  intros v t d Hpos Hv.
  assert (Hsq : 0 < square (v t)) by (rewrite <- length_squared; now apply Rmult_lt_0_compat).
  pose proof (moves_dot v v t d d Hv Hv) as Hd.
  eapply derive_as.
  - apply is_derive_Reals. apply is_derive_Reals in Hd.
    apply (derivable_pt_lim_comp (fun s => dot (v s) (v s)) sqrt); [exact Hd|].
    now apply derivable_pt_lim_sqrt.
  - fold (square (v t)). fold (length (v t)). unfold direction. components. field. lra.
Qed.

(** d' for a v that moves by v_1. *)
Theorem direction_moves : forall v t v_1, 0 < length (v t) -> moves v t v_1 ->
  moves (fun s => direction (v s)) t (direction_rate (v t) v_1).
Proof.
  intros v t d Hpos Hv. pose proof (length_moves v t d Hpos Hv) as Hl.
  eapply moves_as.
  - apply moves_scaled; [|exact Hv]. apply is_derive_inv; [exact Hl | lra].
  - unfold direction_rate, across. generalize (dot (direction (v t)) d). intros m.
    unfold direction. generalize dependent (length (v t)). intros n Hn.
    apply same; components; field; lra.
Qed.

(** d'' for a v that moves by v_1, which moves by v_2. *)
Theorem direction_rate_moves : forall v v_1 t v_2, 0 < length (v t) ->
  moves v t (v_1 t) -> moves v_1 t v_2 ->
  moves (fun s => direction_rate (v s) (v_1 s)) t (direction_second (v t) (v_1 t) v_2).
Proof.
  intros v v_1 t v_2 Hpos Hv Hv1.
  pose proof (length_moves v t (v_1 t) Hpos Hv) as Hl.
  pose proof (direction_moves v t (v_1 t) Hpos Hv) as Hd.
  pose proof (moves_dot _ _ _ _ _ Hd Hv1) as Hm. cbn beta in Hm.
  eapply moves_as.
  - apply moves_scaled; [apply is_derive_inv; [exact Hl | lra]|].
    apply moves_sub; [exact Hv1|]. apply moves_scaled; [exact Hm | exact Hd].
  - rewrite (rate_along_motion (v t) Hpos). unfold direction_second, across.
    assert (Hsplit : sub (v_1 t) (scaled (dot (direction (v t)) (v_1 t)) (direction (v t)))
      = scaled (length (v t)) (direction_rate (v t) (v_1 t))).
    { unfold direction_rate, across. apply same; components; field; lra. }
    rewrite Hsplit. clear Hsplit.
    generalize (dot (direction (v t)) (v_1 t)) (dot (direction (v t)) v_2)
      (direction_rate (v t) (v_1 t)) (direction (v t)). intros m q r d.
    generalize (square r). intros s. generalize dependent (length (v t)). intros n Hn.
    apply same; components; field; lra.
Qed.
